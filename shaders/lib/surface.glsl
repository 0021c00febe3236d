// From a hit (instance, geometry, primitive, barycentrics) to a surface point with its material: the one function that
// rasterised and traced hits share.
#ifndef HELIO_SURFACE_GLSL
#define HELIO_SURFACE_GLSL
#include "lib/bindless.glsl"
#include "lib/bsdf.glsl"
// Of what is in a BLAS, hits read the very vertices that it was built of; of what is not, nothing must agree with them to
// the last bit. (glslang 12 crashes on `precise` in a ray generation shader.)
#define HELIO_PRECISE
#include "lib/deform.glsl"
#include "lib/effects.glsl"
#include "lib/hit.glsl"
#include "lib/math.glsl"
#include "lib/random.glsl"
#include "lib/tables.glsl"

const float kWhiteAlbedo = 0.8;

struct Triangle {
  vec3 p[3];      // world space
  vec3 local[3];  // object space, deformed
  uvec3 vertices;
  GeometryRecord geometry;
};

struct Surface {
  vec3 position;
  vec3 geometric_normal;  // unit, on the side of the viewer
  float reach;            // largest coordinate of its triangle, for offsetOrigin
  vec3 rounding;          // from `position` to the round surface that the vertex normals tell of, on the side of the viewer
  bool rounded;           // it is not 0
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
// Whether its transform turns left to right.
bool mirrors(InstanceRecord instance) {
  return dot(instance.rows[0].xyz, cross(instance.rows[1].xyz, instance.rows[2].xyz)) < 0.0;
}
// By the cofactor matrix: right under non-uniform scale and mirroring, needs no inverse.
vec3 normalToWorld(InstanceRecord instance, vec3 n) {
  const vec3 a = instance.rows[0].xyz, b = instance.rows[1].xyz, c = instance.rows[2].xyz;
  const vec3 v = vec3(dot(cross(b, c), n), dot(cross(c, a), n), dot(cross(a, b), n));
  return mirrors(instance) ? -v : v;
}

// The mesh of an instance at one of its levels of detail.
MeshRecord meshLevel(InstanceRecord instance, uint level) {
  const bool in_blas = level == kLevelInBlas;
  MeshTable meshes = MeshTable(in_blas ? frame.traced_meshes : frame.meshes);
  if (in_blas) level = instance.level;
  const MeshRecord finest = meshes.items[instance.mesh];
  if (level == 0u) return finest;
  return meshes.items[finest.coarser + level - 1u];
}

// How far apart, at most, are the surface that was rasterised and the one that rays from there meet; metres.
float levelGap(InstanceRecord instance, MeshRecord rasterised, uint level) {
  if (level == kLevelInBlas) return 0.0;
  const MeshRecord traced = meshLevel(instance, kLevelInBlas);
  if (traced.first_geometry == rasterised.first_geometry) return 0.0;
  const vec3 scale = vec3(dot(instance.rows[0].xyz, instance.rows[0].xyz), dot(instance.rows[1].xyz, instance.rows[1].xyz),
                          dot(instance.rows[2].xyz, instance.rows[2].xyz));
  return sqrt(maxComponent(scale)) * (rasterised.error + traced.error);
}

// A geometry of a BLAS may hold several submeshes, one behind the other: which of them a ray met.
Hit inSubmesh(Hit hit) {
  if (hit.primitive == kNothing) return hit;
  const MeshRecord mesh = meshLevel(InstanceTable(frame.instances).items[hit.slot], hit.level);
  GeometryTable geometries = GeometryTable(frame.geometries);
  for (uint count; hit.primitive >= (count = geometries.items[mesh.first_geometry + hit.geometry].triangle_count); ++hit.geometry) hit.primitive -= count;
  return hit;
}

float reachOf(Triangle t) { return maxComponent(max(abs(t.p[0]), max(abs(t.p[1]), abs(t.p[2])))); }

Triangle loadTriangle(InstanceRecord instance, uint geometry_index, uint primitive) {
  Triangle t;
  t.geometry = GeometryTable(frame.geometries).items[geometry_index];
  IndexTable indices = IndexTable(t.geometry.indices);
  t.vertices = uvec3(indices.items[3 * primitive], indices.items[3 * primitive + 1], indices.items[3 * primitive + 2]);
  PositionTable positions = PositionTable(t.geometry.positions);
  for (int i = 0; i < 3; ++i) t.local[i] = positions.items[t.vertices[i]];
  if (kDeforming && instance.deform != 0ul) {
    const DeformRecord deform = DeformRef(instance.deform).record;
    for (int i = 0; i < 3; ++i) {
      // What is in a BLAS was deformed already.
      if (deform.positions != 0ul && t.vertices[i] < deform.vertex_count) t.local[i] = PositionTable(deform.positions).items[t.vertices[i]];
      else t.local[i] = deformPosition(deform, instance, t.local[i], t.vertices[i]);
    }
  }
  for (int i = 0; i < 3; ++i) t.p[i] = toWorld(instance, t.local[i]);
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

// Of a ray cone on a triangle.
struct Footprint {
  // An ellipse: how the barycentrics of the second and third vertex change along its long and its short axis.
  bool ellipse;
  vec2 across[2];
  float scale;  // or a circle: its diameter, times the root of the triangle's area in the texture
};

// `seen`: as by the eye, be it in mirrors; what light was scattered into may be blurred in all directions.
Footprint footprintOf(Triangle t, vec3 scaled_normal, vec3 direction, float width, bool seen) {
  Footprint f;
  const float double_area = max(length(scaled_normal), 1e-20);
  const vec3 normal = scaled_normal / double_area;
  const float facing = dot(direction, normal), longer = width / max(abs(facing), 0.02);
  f.scale = longer / sqrt(double_area);
  f.ellipse = seen && width > 0.0;
  if (!f.ellipse) return f;
  const vec3 e1 = t.p[1] - t.p[0], e2 = t.p[2] - t.p[0];
  const vec3 slope = direction - facing * normal;
  const vec3 along = dot(slope, slope) > 1e-8 ? normalize(slope) : normalize(e1);
  const vec3 axes[2] = vec3[](along * longer, cross(normal, along) * width);
  for (int i = 0; i < 2; ++i) f.across[i] = vec2(dot(cross(axes[i], e2), normal), dot(cross(e1, axes[i]), normal)) / double_area;
  return f;
}

// Where a hit lies in the plane of a texture.
struct TexturePoint {
  vec2 uv;
  bool ellipse;
  vec2 axes[2];   // of the ray cone's footprint, in uv
  float diameter; // where that is a circle
};

TexturePoint texturePoint(vec2 uv[3], vec3 w, Footprint f) {
  const vec2 e1 = uv[1] - uv[0], e2 = uv[2] - uv[0];
  TexturePoint p;
  p.uv = uv[0] * w.x + uv[1] * w.y + uv[2] * w.z;
  p.ellipse = f.ellipse;
  if (f.ellipse) for (int i = 0; i < 2; ++i) p.axes[i] = e1 * f.across[i].x + e2 * f.across[i].y;
  else p.diameter = sqrt(abs(e1.x * e2.y - e1.y * e2.x)) * f.scale;
  return p;
}

// The same hit in another channel of texture coordinates, if the mesh has it.
TexturePoint inChannel(uint slot, MaterialRecord material, Triangle t, TexturePoint channel0, vec3 w, Footprint f) {
  const uint channel = bitfieldExtract(material.flags, int(kUvChannelShift + kUvChannelBits * slot), int(kUvChannelBits));
  if (!kUvChannels || channel == 0u || t.geometry.extras == 0ul) return channel0;
  const uint64_t address = VertexExtrasRef(t.geometry.extras).extras.uvs[channel - 1u];
  if (address == 0ul) return channel0;
  UvTable table = UvTable(address);
  return texturePoint(vec2[3](table.items[t.vertices.x], table.items[t.vertices.y], table.items[t.vertices.z]), w, f);
}

// Reads over the ray cone's footprint: an ellipse anisotropically [Akenine-Moeller et al. 2021, Improved shader and texture level of
// detail using ray cones], a circle at its level of detail [Akenine-Moeller et al. 2019, eq. 34].
vec4 readTexture(uint texture_index, TexturePoint p) {
  if (p.ellipse) return textureGrad(textures[nonuniformEXT(texture_index)], p.uv, p.axes[0], p.axes[1]);
  const vec2 size = vec2(textureSize(textures[nonuniformEXT(texture_index)], 0));
  const float lod = 0.5 * log2(size.x * size.y) + log2(max(1e-12, p.diameter));
  return textureLod(textures[nonuniformEXT(texture_index)], p.uv, lod);
}

// From the point with weights `w` of a triangle to the surface through its vertices that its normals tell of, where that is
// convex: rays that leave from there do not meet its flat neighbours at grazing angles [Hanika 2021, Ray Tracing Gems II,
// ch. 4]. In object space; `side`: -1 where the normals point away from the viewer, else 1.
vec3 roundingOf(Triangle t, vec3 w, vec3 normals[3], float side) {
  const vec3 p = t.local[0] * w.x + t.local[1] * w.y + t.local[2] * w.z;
  vec3 rounding = vec3(0.0);
  for (int i = 0; i < 3; ++i) rounding += (w[i] * max(0.0, side * dot(t.local[i] - p, normals[i]))) * normals[i];
  return side * rounding;
}

// Share of its light that a GGX lobe of reflectance 1 scatters once: from the table, bilinear.
float ggxAlbedo(float cos_theta, float alpha) {
  const vec2 p = clamp(vec2(cos_theta, sqrt(alpha)), 0.0, 1.0) * vec2(kGgxAlbedoCosines - 1u, kGgxAlbedoAlphas - 1u);
  const uvec2 i = min(uvec2(p), uvec2(kGgxAlbedoCosines - 2u, kGgxAlbedoAlphas - 2u));
  const vec2 f = p - vec2(i);
  const uint row = i.y * kGgxAlbedoCosines + i.x, above = row + kGgxAlbedoCosines;
  GgxAlbedoRef table = GgxAlbedoRef(frame.ggx_albedo);
  return mix(mix(table.albedo.share[row], table.albedo.share[row + 1u], f.x),
             mix(table.albedo.share[above], table.albedo.share[above + 1u], f.x), f.y);
}

vec3 vertexColor(Triangle t, vec3 w) {
  if (t.geometry.extras == 0ul) return vec3(1.0);
  const uint64_t address = VertexExtrasRef(t.geometry.extras).extras.colors;
  if (address == 0ul) return vec3(1.0);
  ColorTable table = ColorTable(address);
  vec3 color = vec3(0.0);
  for (int i = 0; i < 3; ++i) {
    const uvec2 packed_color = table.items[t.vertices[i]];
    color += w[i] * vec3(unpackUnorm2x16(packed_color.x), unpackUnorm2x16(packed_color.y).x);
  }
  return color;
}

// Colours of things that have numbers, far apart for neighbours.
vec3 colorOfNumber(uint number) { return 0.15 + 0.85 * randomAt(uvec2(number, 0u), 0u, 0u).xyz; }

// What kMaterials asks to see of a surface (shared/material_override.h).
vec3 shownProperty(vec3 albedo, vec2 roughness_metallic, vec3 emission, vec3 normal, vec3 geometric_normal, vec2 uv, uint slot, uint material) {
  if (kMaterials == kShowAlbedo) return albedo;
  if (kMaterials == kShowRoughnessMetallic) return vec3(0.0, roughness_metallic);
  if (kMaterials == kShowEmission) return emission;
  if (kMaterials == kShowNormals) return 0.5 + 0.5 * normal;
  if (kMaterials == kShowGeometricNormals) return 0.5 + 0.5 * geometric_normal;
  if (kMaterials == kShowTextureCoordinates) return vec3(fract(uv), 0.0);
  return colorOfNumber(kMaterials == kShowInstances ? slot : material);
}

Surface loadSurface(Hit hit, vec3 direction, float cone_width_at_origin, float cone_spread, vec3 origin) {
  const InstanceRecord instance = InstanceTable(frame.instances).items[hit.slot];
  const MeshRecord mesh = meshLevel(instance, hit.level);
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

  // Interpolate the shading normal.
  vec3 normals[3] = vec3[3](octahedral(a0.normal), octahedral(a1.normal), octahedral(a2.normal));
  vec3 tangents[3] = vec3[3](octahedral(a0.tangent & ~1u), octahedral(a1.tangent & ~1u), octahedral(a2.tangent & ~1u));
  if (kDeforming && instance.deform != 0ul) {
    const DeformRecord deform = DeformRef(instance.deform).record;
    for (int i = 0; i < 3; ++i) deformFrame(deform, t.vertices[i], normals[i], tangents[i]);
  }
  vec3 normal = normalToWorld(instance, normals[0] * w.x + normals[1] * w.y + normals[2] * w.z);
  const float normal_length = length(normal);
  normal = normal_length > 1e-20 ? normal / normal_length : s.geometric_normal;
  const bool from_behind = dot(normal, s.geometric_normal) < 0.0;
  s.rounding = vec3(0.0);
  if (frame.round_surfaces != 0u && (a0.normal != a1.normal || a0.normal != a2.normal)) {
    s.rounding = vectorToWorld(instance, roundingOf(t, w, normals, from_behind ? -1.0 : 1.0));
  }
  // Where the rasteriser drew another level than the BLAS has, rays leave from above both [Kelling §3.2.1].
  s.rounding += levelGap(instance, mesh, hit.level) * s.geometric_normal;
  s.rounded = dot(s.rounding, s.rounding) > 0.0;

  vec4 base = material.base_color;
  float metallic = material.metallic, roughness = material.roughness;
  Dielectric dielectric = kIor15;
  SpecularRecord specular;
  const bool has_specular = kSpecular && material.specular != 0u;
  if (has_specular) specular = SpecularRef(frame.materials + material.specular).specular;
  s.emission = material.emission;
  if (kTextures) {
    const float cone_width = cone_width_at_origin + cone_spread * distance(origin, s.position);
    const Footprint footprint = footprintOf(t, scaled_normal, direction, cone_width, cone_spread <= frame.pixel_spread);
    const TexturePoint p = texturePoint(vec2[3](a0.uv, a1.uv, a2.uv), w, footprint);
    if (material.base_color_texture != kNoTexture)
      base *= readTexture(material.base_color_texture, inChannel(kSlotBaseColor, material, t, p, w, footprint));
    if (material.metallic_roughness_texture != kNoTexture) {
      const vec4 mr = readTexture(material.metallic_roughness_texture, inChannel(kSlotMetallicRoughness, material, t, p, w, footprint));
      roughness *= mr.g;
      metallic *= mr.b;
    }
    if (kEmissiveTriangles && material.emissive_texture != kNoTexture)
      // Channel 0 and the finest level, as light sampling reads it: both must see the same emitter, or their weights do not add
      // up to 1.
      s.emission *= textureLod(textures[nonuniformEXT(material.emissive_texture)], p.uv, 0.0).rgb;
    if (kNormalMaps && kMaterials != kMaterialsLambert && material.normal_texture != kNoTexture) {
      vec3 tangent = vectorToWorld(instance, tangents[0] * w.x + tangents[1] * w.y + tangents[2] * w.z);
      tangent -= normal * dot(normal, tangent);
      const float tangent_length = length(tangent);
      if (tangent_length > 1e-20) {
        tangent /= tangent_length;
        // A cross product of what was mirrored is turned over: mirroring instances change the handedness.
        const bool right_handed = ((a0.tangent & 1u) != 0u) != mirrors(instance);
        const vec3 bitangent = right_handed ? cross(normal, tangent) : cross(tangent, normal);
        vec3 m = readTexture(material.normal_texture, inChannel(kSlotNormal, material, t, p, w, footprint)).xyz * 2.0 - 1.0;
        m.xy *= material.normal_scale;
        normal = normalize(m.x * tangent + m.y * bitangent + max(m.z, 1e-3) * normal);
      }
    }
    if (has_specular && specular.texture != kNoTexture)
      specular.weight *= readTexture(specular.texture, inChannel(kSlotSpecular, material, t, p, w, footprint)).a;
    if (has_specular && specular.color_texture != kNoTexture)
      specular.f0 *= readTexture(specular.color_texture, inChannel(kSlotSpecularColor, material, t, p, w, footprint)).rgb;
  }
  if (kVertexColors) base.rgb *= vertexColor(t, w);
  if (has_specular)
    dielectric = Dielectric(min(specular.f0, vec3(1.0)) * specular.weight, specular.f90 * specular.weight,
                            (material.flags & kMaterialTintedSpecular) != 0u);
  bool lambert = (material.flags & kMaterialLambert) != 0u;
  const bool relit = kMaterials == kMaterialsLambert || kMaterials == kMaterialsWhite;
  if (relit) lambert = true;
  if (kMaterials == kMaterialsWhite) base.rgb = vec3(kWhiteAlbedo);
  const vec3 albedo = base.rgb;
  if (kUnlit && !relit && (material.flags & kMaterialUnlit) != 0u) {
    s.emission = base.rgb;
    base.rgb = vec3(0.0);
    lambert = true;
  }

  // Bring the shading normal to the viewer's side.
  if (from_behind) normal = -normal;
  // A shading normal that faces away from the viewer is bent back until it just faces them.
  const float facing = dot(normal, -direction);
  if (facing < 1e-3) normal = normalize(normal + (1e-3 - facing) * -direction);
  if (kMaterials >= kShowAlbedo) {  // a black surface that shines with what is shown
    const vec2 uv = a0.uv * w.x + a1.uv * w.y + a2.uv * w.z;
    s.emission = shownProperty(albedo, vec2(roughness, metallic), s.emission, normal, s.geometric_normal, uv, hit.slot, t.geometry.material);
    base.rgb = vec3(0.0);
    lambert = true;
  }
  s.frame_ = basis(normal);
  s.bsdf = makeBsdf(base.rgb, metallic, roughness, lambert, dielectric);

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
