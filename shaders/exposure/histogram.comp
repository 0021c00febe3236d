#version 460
#extension GL_GOOGLE_include_directive : require
// Histogram of log2 luminance: bin 0 holds black, bins 1.. span kLowest..kHighest.
#include "exposure/bins.glsl"
#include "lib/bindless.glsl"
#include "lib/math.glsl"
#include "lib/tables.glsl"

layout(local_size_x = 16, local_size_y = 16) in;

shared uint bins[kHistogramBins];

void main() {
  bins[gl_LocalInvocationIndex] = 0u;
  barrier();
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (pixel.x < int(frame.width) && pixel.y < int(frame.height)) {
    const float position = binPosition(luminance(imageLoad(images_rgba32f[push.source], pixel).rgb));
    const uint bin = uint(position);
    const uint upper = bin == 0u ? 0u : uint(float(kParts) * fract(position) + 0.5);
    atomicAdd(bins[bin], kParts - upper);
    if (upper > 0u) atomicAdd(bins[bin + 1u], upper);
  }
  barrier();
  const uint count = bins[gl_LocalInvocationIndex];
  if (count > 0u) atomicAdd(ViewStateRef(frame.view_state).state.histogram[gl_LocalInvocationIndex], count);
}
