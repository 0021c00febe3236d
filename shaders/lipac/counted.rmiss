#version 460
#extension GL_EXT_ray_tracing : require
#extension GL_GOOGLE_include_directive : require
#include "lib/hit.glsl"

layout(location = 2) rayPayloadInEXT CountedHit payload;

void main() { payload.hit.primitive = kNothing; }
