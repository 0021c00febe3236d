// Alpha masks: where a material's alpha is below its cutoff there is no surface.
#ifndef HELIO_CUT_OUT_GLSL
#define HELIO_CUT_OUT_GLSL
#include "lib/bindless.glsl"
#include "lib/effects.glsl"
#include "lib/tables.glsl"

// Coordinates with which the material's base colour is read, of one vertex.
vec2 baseColorUv(GeometryRecord geometry, MaterialRecord material, uint vertex) {
  const uint channel = bitfieldExtract(material.flags, int(kUvChannelShift + kUvChannelBits * kSlotBaseColor), int(kUvChannelBits));
  if (kUvChannels && channel != 0u && geometry.extras != 0ul) {
    const uint64_t address = VertexExtrasRef(geometry.extras).extras.uvs[channel - 1u];
    if (address != 0ul) return UvTable(address).items[vertex];
  }
  return AttributeTable(geometry.attributes).items[vertex].uv;
}

float vertexAlpha(GeometryRecord geometry, uint vertex) {
  if (!kVertexColors || geometry.extras == 0ul) return 1.0;
  const uint64_t address = VertexExtrasRef(geometry.extras).extras.colors;
  return address == 0ul ? 1.0 : unpackUnorm2x16(ColorTable(address).items[vertex].y).y;
}

// At the finest level of detail, at any distance: a leaf must not grow or vanish with it.
bool isCutOut(MaterialRecord material, vec2 uv, float vertex_alpha) {
  if ((material.flags & kMaterialMasked) == 0u) return false;
  float alpha = material.base_color.a * vertex_alpha;
  if (material.base_color_texture != kNoTexture) alpha *= textureLod(textures[nonuniformEXT(material.base_color_texture)], uv, 0.0).a;
  return alpha < 1.0;
}

// At a point of a triangle; `w`: its barycentric weights.
bool isCutOut(GeometryRecord geometry, uvec3 vertices, vec3 w) {
  const MaterialRecord material = MaterialTable(frame.materials).items[geometry.material];
  vec2 uv = vec2(0.0);
  float alpha = 0.0;
  for (int i = 0; i < 3; ++i) {
    uv += w[i] * baseColorUv(geometry, material, vertices[i]);
    alpha += w[i] * vertexAlpha(geometry, vertices[i]);
  }
  return isCutOut(material, uv, alpha);
}

#endif
