#version 460
#extension GL_GOOGLE_include_directive : require
// A shadow map without anything in it. By the API's own clear, GPUs with few units for drawing took longer than for all that is drawn.
#include "raster/raster.glsl"

layout(local_size_x = 16, local_size_y = 16) in;

void main() {
  const ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
  if (all(lessThan(texel, imageSize(images_r32ui[raster.image])))) imageStore(images_r32ui[raster.image], texel, uvec4(0u));
}
