#version 460
#extension GL_GOOGLE_include_directive : require
// Running mean over samples. Dropped samples count as nothing: alpha holds the number of samples kept.
#include "lib/accumulation.glsl"
#include "lib/bindless.glsl"
#include "lib/faults.glsl"
#include "lib/random.glsl"
#include "lib/tables.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

const uint kRounding = 0xffffffffu;  // no decision of a path has this number

void main() {
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (pixel.x >= int(frame.width) || pixel.y >= int(frame.height)) return;
  const vec4 sampled = imageLoad(images_rgba32f[frame.radiance], pixel);
  vec4 mean = push.accumulated == 0u ? vec4(0.0) : imageLoad(images_rgba32f[frame.accumulation], pixel);
  // What is broken must not stay for good: the mean begins again.
  const uint fault = faultOf(mean.rgb);
  if (fault != kNoFault) {
    countFault(kFaultAccumulate, fault, uvec2(pixel), 0u);
    mean = vec4(0.0);
  }
  if (sampled.a > 0.0) mean = runningMean(mean, sampled.rgb, randomAt(uvec2(pixel), push.accumulated, kRounding).xyz);
  imageStore(images_rgba32f[frame.accumulation], pixel, mean);
}
