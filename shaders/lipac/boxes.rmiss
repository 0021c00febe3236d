#version 460
#extension GL_EXT_ray_tracing : require
// No box, or no further one: the payload says so already.

void main() {}
