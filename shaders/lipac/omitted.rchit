#version 460
#extension GL_EXT_ray_tracing : require
#extension GL_GOOGLE_include_directive : require
// A ray meets the bounds of an omitted instance: ray generation goes on from there.
#include "lib/hit.glsl"

layout(location = 2) rayPayloadInEXT MetBoxes payload;

void main() {
  payload.omitted = gl_InstanceCustomIndexEXT;
  payload.omitted_distance = gl_HitTEXT;
}
