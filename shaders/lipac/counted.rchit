#version 460
#extension GL_EXT_ray_tracing : require
#extension GL_GOOGLE_include_directive : require
// Says who was hit; boxes behind it, which the traversal came upon before, do not count.
#include "lib/hit.glsl"

layout(location = 2) rayPayloadInEXT CountedHit payload;
hitAttributeEXT vec2 barycentrics;

void main() {
  payload.hit = Hit(gl_InstanceCustomIndexEXT, gl_GeometryIndexEXT, gl_PrimitiveID, barycentrics, kLevelInBlas);
  if (payload.cell_distance > gl_HitTEXT) payload.cell = kNothing;
  if (payload.omitted_distance > gl_HitTEXT) payload.omitted = kNothing;
}
