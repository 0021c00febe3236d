#version 460
#extension GL_GOOGLE_include_directive : require
// One value in every texel of an rgba32f image.
#include "lib/bindless.glsl"
#include "probe.h"

layout(local_size_x = 8, local_size_y = 8) in;
layout(push_constant, scalar) uniform Push { FillConstants fill; };

void main() {
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (all(lessThan(pixel, ivec2(fill.size)))) imageStore(images_rgba32f[fill.slot], pixel, fill.value);
}
