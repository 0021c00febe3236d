// Sampling of lamps: a punctual light or an emissive instance is chosen by lib/lights.glsl; of an instance then a triangle in
// proportion to its power among the mesh's (alias method [Walker 1977]), then a point by area.
#ifndef HELIO_EMITTERS_GLSL
#define HELIO_EMITTERS_GLSL
#include "lib/cut_out.glsl"
#include "lib/lights.glsl"
#include "lib/surface.glsl"

const float kBelowOne = 0.99999994;  // the largest float below 1

struct EmitterSample {
  vec3 position;
  vec3 normal;      // unit; both faces shine
  float reach;      // as Surface.reach
  vec3 emission;
  float pdf_area;   // samples per square metre; 0: no sample
};

// Of the instance that was selected as seen from `p`; `u` in [0, 1)^2 chooses the triangle and the point.
EmitterSample sampleEmitter(uint slot, vec3 p, vec2 u) {
  EmitterSample s;
  s.pdf_area = 0.0;
  const InstanceRecord instance = InstanceTable(frame.instances).items[slot];
  const MeshRecord mesh = MeshTable(frame.meshes).items[instance.mesh];
  // What is left of u.x after each choice is uniform again: so a well spread u spreads well over a lamp of many triangles.
  u.x *= float(mesh.emitter_count);
  const uint k = min(uint(u.x), mesh.emitter_count - 1);
  u.x -= float(k);
  EmitterTriangle triangle = EmitterTriangleTable(frame.emitter_triangles).items[mesh.first_emitter + k];
  if (u.x < triangle.keep) {
    u.x /= triangle.keep;
  } else {
    u.x = (u.x - triangle.keep) / (1.0 - triangle.keep);
    triangle = EmitterTriangleTable(frame.emitter_triangles).items[mesh.first_emitter + triangle.alias];
  }
  u.x = min(u.x, kBelowOne);

  // Choose a point: uniform barycentrics by folding the unit square.
  const Triangle t = loadTriangle(instance, mesh.first_geometry + triangle.geometry, triangle.primitive);
  const float root = sqrt(u.x);
  const vec3 w = vec3(1.0 - root, root * (1.0 - u.y), root * u.y);
  s.position = t.p[0] * w.x + t.p[1] * w.y + t.p[2] * w.z;
  s.reach = reachOf(t);
  const vec3 n = cross(t.p[1] - t.p[0], t.p[2] - t.p[0]);
  const float double_area = length(n);
  if (!(double_area > 0.0)) return s;
  s.normal = n / double_area;
  s.pdf_area = lampRate(p, slot, instance.emitter_weight) * triangle.pmf / (0.5 * double_area);

  const MaterialRecord material = MaterialTable(frame.materials).items[t.geometry.material];
  s.emission = material.emission;
  if (kAlphaMasks && isCutOut(t.geometry, t.vertices, w)) s.emission = vec3(0.0);
  if (kTextures && material.emissive_texture != kNoTexture) {
    AttributeTable attributes = AttributeTable(t.geometry.attributes);
    const vec2 uv = attributes.items[t.vertices.x].uv * w.x + attributes.items[t.vertices.y].uv * w.y + attributes.items[t.vertices.z].uv * w.z;
    s.emission *= textureLod(textures[nonuniformEXT(material.emissive_texture)], uv, 0.0).rgb;
  }
  return s;
}

struct PunctualSample {
  vec3 direction;     // unit, towards the light
  float distance;
  vec3 irradiance;    // of what faces it
  float rate;         // how often the vertex draws it, on average
};

// The punctual light that was selected as seen from `p`. Its light falls with the squared distance, faded out towards its
// range [KHR_lights_punctual].
PunctualSample samplePunctual(uint slot, vec3 p) {
  const PunctualRecord light = PunctualTable(frame.punctual_lights).items[slot & ~kPunctualLight];
  PunctualSample s;
  s.rate = lampRate(p, slot, light.weight);
  if (light.type == kLightDirectional) {
    s.direction = light.position;
    s.distance = kFar;
    s.irradiance = light.intensity;
    return s;
  }
  const vec3 to_light = light.position - p;
  const float distance2 = max(dot(to_light, to_light), 1e-12);
  s.distance = sqrt(distance2);
  s.direction = to_light / s.distance;
  const float reached = s.distance * light.inverse_range, reached2 = reached * reached;
  s.irradiance = light.intensity * (clamp(1.0 - reached2 * reached2, 0.0, 1.0) / distance2);
  if (light.type == kLightSpot) {
    const float cone = clamp(dot(light.direction, -s.direction) * light.cone_scale + light.cone_offset, 0.0, 1.0);
    s.irradiance *= cone * cone;
  }
  return s;
}

#endif
