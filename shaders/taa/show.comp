#version 460
#extension GL_GOOGLE_include_directive : require
// What temporal anti-aliasing has made becomes the picture, and the mean that the next tick goes on from.
#include "taa/taa.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

void main() {
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (!inPicture(pixel)) return;
  const uvec2 resolved = imageLoad(images_rg32ui[taa.resolved], pixel).xy;
  imageStore(images_rg32ui[taa.mean], pixel, uvec4(resolved, 0u, 0u));
  imageStore(images_rgba32f[frame.radiance], pixel, vec4(unpackHalf4(resolved).rgb / history.unit, 1.0));
}
