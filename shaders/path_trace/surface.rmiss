#version 460
#extension GL_EXT_ray_tracing : require
#extension GL_GOOGLE_include_directive : require
#include "lib/hit.glsl"

layout(location = 0) rayPayloadInEXT Hit payload;

void main() { payload.primitive = kNothing; }
