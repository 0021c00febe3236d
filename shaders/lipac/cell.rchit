#version 460
#extension GL_EXT_ray_tracing : require
#extension GL_GOOGLE_include_directive : require
// A ray meets a hitbox: ray generation goes on from there.
#include "lib/hit.glsl"

layout(location = 2) rayPayloadInEXT MetBoxes payload;

void main() {
  payload.cell = gl_InstanceCustomIndexEXT;
  payload.cell_distance = gl_HitTEXT;
}
