#version 460
#extension GL_GOOGLE_include_directive : require
// How many paths a pixel gets for its deviation, so that all young pixels together get what the tick may spend: by bisection, since
// no pixel gets less than none or more than the most. One group; the bins are counts, so that the result does not depend on any order.
#include "lib/extra_samples.glsl"

layout(local_size_x = kNoiseBins) in;

const float kMostShare = 65536.0;  // a thousand paths for the least deviation there is
const uint kHalvings = 32u;

shared float paths[kNoiseBins];

float allPaths(uint thread, float own) {
  barrier();
  paths[thread] = own;
  for (uint half_ = kNoiseBins / 2u; half_ > 0u; half_ /= 2u) {
    barrier();
    if (thread < half_) paths[thread] += paths[thread + half_];
  }
  barrier();
  return paths[0];
}

void main() {
  const uint bin = gl_LocalInvocationIndex;
  ExtraSamplesRef extra = ExtraSamplesRef(frame.extra_samples);
  const float pixels = float(extra.samples.young[bin]);
  const float budget = frame.extra_paths * float(frame.width) * float(frame.height);
  float least = 0.0, most = kMostShare;
  if (allPaths(bin, pixels * extraPaths(most, bin)) <= budget) {
    least = most;  // there is enough for all
  } else {
    for (uint i = 0u; i < kHalvings; ++i) {
      const float middle = 0.5 * (least + most);
      if (allPaths(bin, pixels * extraPaths(middle, bin)) <= budget) least = middle;
      else most = middle;
    }
  }
  if (bin == 0u) extra.samples.share = least;
}
