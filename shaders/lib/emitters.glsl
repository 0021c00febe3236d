// Sampling of emissive triangles: an instance (lib/lights.glsl), then a triangle in proportion to its power among the mesh's
// (alias method [Walker 1977]), then a point by area.
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
  float pdf_area;   // per square metre; 0: no sample
};

// As seen from `p`; `select` in [0, 1)^3 chooses the instance, `u` in [0, 1)^2 the triangle and the point.
EmitterSample sampleEmitter(vec3 p, vec3 select, vec2 u) {
  EmitterSample s;
  s.pdf_area = 0.0;
  const uint slot = selectEmitter(p, select);
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
  s.pdf_area = emitterProbability(p, slot, instance.emitter_weight) * triangle.pmf / (0.5 * double_area);

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

#endif
