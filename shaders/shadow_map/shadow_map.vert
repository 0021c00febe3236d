#version 460
#extension GL_GOOGLE_include_directive : require
// A cascade of the sun's shadow map.
#include "primary/vertex.glsl"

layout(location = 0) flat out uint out_material;
layout(location = 1) out vec3 out_mask;

void main() {
  const ShadowMap map = ShadowMapRef(draw.shadow_map).map;
  const ShadowCascade cascade = map.cascades[draw.cascade];
  const Vertex v = placeVertex(cascade.centre);
  gl_Position = shadowClip(map, cascade, v.relative);
  out_material = v.material;
  out_mask = v.mask;
}
