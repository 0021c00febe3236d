#version 460
#extension GL_GOOGLE_include_directive : require
// Sums up how noisy the denoiser says its picture is: the image `radiance` holds each pixel's relative variance beside its light.
#include "lib/bindless.glsl"
#include "lib/tables.glsl"

const uint kSide = 16u;
layout(local_size_x = kSide, local_size_y = kSide) in;

const float kMost = 64.0;  // of a pixel: one bright sample in the dark is no statement about the picture

shared float sums[kSide * kSide];

void main() {
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  const uint i = gl_LocalInvocationIndex;
  const bool inside = pixel.x < int(frame.width) && pixel.y < int(frame.height);
  sums[i] = inside ? clamp(imageLoad(images_rgba32f[frame.radiance], pixel).a, 0.0, kMost) : 0.0;
  barrier();
  for (uint half_way = kSide * kSide / 2u; half_way > 0u; half_way /= 2u) {
    if (i < half_way) sums[i] += sums[i + half_way];
    barrier();
  }
  if (i != 0u) return;
  ViewStateRef view = ViewStateRef(frame.view_state);
  const uint sum = uint(sums[0] * float(kVarianceUnits) + 0.5);
  const uint before = atomicAdd(view.state.variance_low, sum);
  if (before + sum < before) atomicAdd(view.state.variance_high, 1u);
}
