#version 460
#extension GL_GOOGLE_include_directive : require
// Automatic exposure: the geometric mean of the luminances between the 20th and the 95th percentile is brought to middle
// grey, so that neither deep shadows nor lamps decide. Clears the histogram for the next tick.
#include "exposure/bins.glsl"
#include "lib/tables.glsl"

layout(local_size_x = 1) in;

const float kMiddleGrey = 0.22;
const float kFrom = 0.20;
const float kTo = 0.95;

void main() {
  ViewStateRef view = ViewStateRef(frame.view_state);
  uint total = 0u;
  for (uint i = 0u; i < kHistogramBins; ++i) total += view.state.histogram[i];
  const float from = kFrom * float(total), to = kTo * float(total);
  float below = 0.0, weight = 0.0, sum = 0.0;
  for (uint i = 0u; i < kHistogramBins; ++i) {
    const float count = float(view.state.histogram[i]);
    const float inside = max(0.0, min(below + count, to) - max(below, from));
    below += count;
    if (i > 0u) {
      sum += inside * logLuminanceOf(i);
      weight += inside;
    }
    view.state.histogram[i] = 0u;
  }
  if (weight <= 0.0) return;  // a black picture says nothing: keep what there is
  const float target = push.exposure_bias * kMiddleGrey / exp2(sum / weight);
  const float present = view.state.exposure;
  view.state.exposure = present > 0.0 ? exp2(mix(log2(present), log2(target), push.adaptation)) : target;
}
