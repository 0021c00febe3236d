#version 460
#extension GL_EXT_ray_tracing : require
#extension GL_GOOGLE_include_directive : require
// A ray meets the bounds of an omitted instance: ray generation counts it and goes on from there.
#include "lib/hit.glsl"

layout(location = 0) rayPayloadInEXT Hit payload;

void main() { payload = Hit(gl_InstanceCustomIndexEXT, kMetOmitted, 0u, vec2(gl_HitTEXT, 0.0), 0u); }
