#version 460
#extension GL_EXT_ray_tracing : require

layout(location = 0) rayPayloadInEXT uint hits;

void main() { hits += 0x10000u; }
