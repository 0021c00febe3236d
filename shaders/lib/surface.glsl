// From a hit (instance, geometry, primitive, barycentrics) to a surface point with its material: the one function that
// rasterised and traced hits share.
#ifndef HELIO_SURFACE_GLSL
#define HELIO_SURFACE_GLSL
#include "lib/bindless.glsl"
#include "lib/bsdf.glsl"
#include "lib/effects.glsl"
#include "lib/hit.glsl"
#include "lib/math.glsl"
#include "lib/tables.glsl"

// A triangle in world space.
struct Triangle {
  vec3 p[3];
  uvec3 vertices;
  GeometryRecord geometry;
};

struct Surface {
  vec3 position;
  vec3 geometric_normal;  // unit, on the side of the viewer
  float reach;            // largest coordinate of its triangle, for offsetOrigin
  mat3 frame_;            // columns: tangent, bitangent, shading normal; on the side of the viewer
  vec3 emission;
  Bsdf bsdf;
  uint slot;              // the instance
  float emitter_weight;   // of the instance, for lib/lights.glsl
  float emitter_pdf_area; // density per area with which light sampling picks this point once it has picked the instance; 0: never
};

vec3 toWorld(InstanceRecord instance, vec3 p) {
  const vec4 h = vec4(p, 1.0);
  return vec3(dot(instance.rows[0], h), dot(instance.rows[1], h), dot(instance.rows[2], h));
}
vec3 vectorToWorld(InstanceRecord instance, vec3 v) {
  return vec3(dot(instance.rows[0].xyz, v), dot(instance.rows[1].xyz, v), dot(instance.rows[2].xyz, v));
}
// By the cofactor matrix: right under non-uniform scale and mirroring, needs no inverse.
vec3 normalToWorld(InstanceRecord instance, vec3 n) {
  const vec3 a = instance.rows[0].xyz, b = instance.rows[1].xyz, c = instance.rows[2].xyz;
  const vec3 v = vec3(dot(cross(b, c), n), dot(cross(c, a), n), dot(cross(a, b), n));
  return dot(a, cross(b, c)) < 0.0 ? -v : v;
}

float reachOf(Triangle t) { return maxComponent(max(abs(t.p[0]), max(abs(t.p[1]), abs(t.p[2])))); }

Triangle loadTriangle(InstanceRecord instance, uint geometry_index, uint primitive) {
  Triangle t;
  t.geometry = GeometryTable(frame.geometries).items[geometry_index];
  IndexTable indices = IndexTable(t.geometry.indices);
  t.vertices = uvec3(indices.items[3 * primitive], indices.items[3 * primitive + 1], indices.items[3 * primitive + 2]);
  PositionTable positions = PositionTable(t.geometry.positions);
  for (int i = 0; i < 3; ++i) t.p[i] = toWorld(instance, positions.items[t.vertices[i]]);
  return t;
}

// Barycentrics of where the line from `origin` along `direction` meets the triangle's plane; clamped to the triangle,
// since a rasterised edge pixel may lie outside by a rounding error.
vec2 intersectPlane(Triangle t, vec3 origin, vec3 direction) {
  const vec3 e1 = t.p[1] - t.p[0], e2 = t.p[2] - t.p[0];
  const vec3 q = cross(direction, e2);
  const float det = dot(e1, q);
  if (abs(det) < 1e-30) return vec2(1.0 / 3.0);
  const vec3 s = origin - t.p[0];
  vec2 b = vec2(dot(s, q), dot(direction, cross(s, e1))) / det;
  b = max(b, vec2(0.0));
  return b / max(1.0, b.x + b.y);
}

// Level of detail of a texture read [Akenine-Moeller et al. 2019, eq. 34]: `cone_width` is the ray cone's width at the hit.
float lodOf(uint texture_index, float uv_per_world, float cone_width, float cos_theta) {
  const vec2 size = vec2(textureSize(textures[nonuniformEXT(texture_index)], 0));
  return 0.5 * log2(size.x * size.y) + log2(max(1e-12, uv_per_world * cone_width / max(abs(cos_theta), 0.02)));
}

Surface loadSurface(Hit hit, vec3 direction, float cone_width_at_origin, float cone_spread, vec3 origin) {
  const InstanceRecord instance = InstanceTable(frame.instances).items[hit.slot];
  const MeshRecord mesh = MeshTable(frame.meshes).items[instance.mesh];
  const Triangle t = loadTriangle(instance, mesh.first_geometry + hit.geometry, hit.primitive);
  const MaterialRecord material = MaterialTable(frame.materials).items[t.geometry.material];
  const vec3 w = vec3(1.0 - hit.barycentrics.x - hit.barycentrics.y, hit.barycentrics);
  AttributeTable attributes = AttributeTable(t.geometry.attributes);
  const VertexAttributes a0 = attributes.items[t.vertices.x];
  const VertexAttributes a1 = attributes.items[t.vertices.y];
  const VertexAttributes a2 = attributes.items[t.vertices.z];

  Surface s;
  s.position = t.p[0] * w.x + t.p[1] * w.y + t.p[2] * w.z;
  s.reach = reachOf(t);
  const vec3 scaled_normal = cross(t.p[1] - t.p[0], t.p[2] - t.p[0]);
  const float double_area = length(scaled_normal);
  s.geometric_normal = double_area > 0.0 ? scaled_normal / double_area : -direction;
  if (dot(s.geometric_normal, direction) > 0.0) s.geometric_normal = -s.geometric_normal;

  // Interpolate the shading normal and bring it to the viewer's side.
  vec3 normal = normalToWorld(instance, octahedral(a0.normal) * w.x + octahedral(a1.normal) * w.y + octahedral(a2.normal) * w.z);
  const float normal_length = length(normal);
  normal = normal_length > 1e-20 ? normal / normal_length : s.geometric_normal;
  if (dot(normal, s.geometric_normal) < 0.0) normal = -normal;

  vec4 base = material.base_color;
  float metallic = material.metallic, roughness = material.roughness;
  s.emission = material.emission;
  if (kTextures) {
    const vec2 uv = a0.uv * w.x + a1.uv * w.y + a2.uv * w.z;
    const vec2 uv1 = a1.uv - a0.uv, uv2 = a2.uv - a0.uv;
    const float uv_per_world = sqrt(abs(uv1.x * uv2.y - uv1.y * uv2.x) / max(double_area, 1e-20));
    const float cone_width = cone_width_at_origin + cone_spread * distance(origin, s.position);
    const float cos_theta = dot(direction, s.geometric_normal);
    if (material.base_color_texture != kNoTexture)
      base *= textureLod(textures[nonuniformEXT(material.base_color_texture)], uv,
                         lodOf(material.base_color_texture, uv_per_world, cone_width, cos_theta));
    if (material.metallic_roughness_texture != kNoTexture) {
      const vec4 mr = textureLod(textures[nonuniformEXT(material.metallic_roughness_texture)], uv,
                                 lodOf(material.metallic_roughness_texture, uv_per_world, cone_width, cos_theta));
      roughness *= mr.g;
      metallic *= mr.b;
    }
    if (kEmissiveTriangles && material.emissive_texture != kNoTexture)
      // The finest level, as light sampling reads it: both must see the same emitter, or their weights do not add up to 1.
      s.emission *= textureLod(textures[nonuniformEXT(material.emissive_texture)], uv, 0.0).rgb;
    if (kNormalMaps && material.normal_texture != kNoTexture) {
      vec3 tangent = vectorToWorld(instance, octahedral(a0.tangent & ~1u) * w.x + octahedral(a1.tangent & ~1u) * w.y + octahedral(a2.tangent & ~1u) * w.z);
      tangent -= normal * dot(normal, tangent);
      const float tangent_length = length(tangent);
      if (tangent_length > 1e-20) {
        tangent /= tangent_length;
        const float handedness = (a0.tangent & 1u) != 0u ? 1.0 : -1.0;
        vec3 m = textureLod(textures[nonuniformEXT(material.normal_texture)], uv,
                            lodOf(material.normal_texture, uv_per_world, cone_width, cos_theta)).xyz * 2.0 - 1.0;
        m.xy *= material.normal_scale;
        normal = normalize(m.x * tangent + m.y * handedness * cross(normal, tangent) + max(m.z, 1e-3) * normal);
      }
    }
  }

  // A shading normal that faces away from the viewer is bent back until it just faces them.
  const float facing = dot(normal, -direction);
  if (facing < 1e-3) normal = normalize(normal + (1e-3 - facing) * -direction);
  s.frame_ = basis(normal);
  s.bsdf = makeBsdf(base.rgb, metallic, roughness, (material.flags & kMaterialLambert) != 0u);

  // p(this point | instance) by area = p(triangle | mesh) / area.
  s.slot = hit.slot;
  s.emitter_weight = instance.emitter_weight;
  s.emitter_pdf_area = 0.0;
  if (kEmissiveTriangles && t.geometry.emitter_offset != kNoTexture && double_area > 0.0) {
    const uint emitter = mesh.first_emitter + t.geometry.emitter_offset + hit.primitive;
    s.emitter_pdf_area = EmitterTriangleTable(frame.emitter_triangles).items[emitter].pmf / (0.5 * double_area);
  }
  return s;
}

#endif
