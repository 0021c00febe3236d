#ifndef HELIO_BINS_GLSL
#define HELIO_BINS_GLSL
#include "shared/frame.h"

const float kLowest = -16.0;   // log2 of radiance
const float kHighest = 16.0;

const uint kParts = 16u;       // a pixel's weight, split between the two nearest bins so that no step shows

// Position among the bins: 0 is black, 1 .. kHistogramBins - 1 span the range.
float binPosition(float luminance) {
  if (!(luminance > exp2(kLowest))) return 0.0;
  const float t = (log2(luminance) - kLowest) / (kHighest - kLowest);
  return 1.0 + clamp(t, 0.0, 1.0) * float(kHistogramBins - 2u);
}
float logLuminanceOf(uint bin) { return kLowest + (float(bin) - 1.0) / float(kHistogramBins - 2u) * (kHighest - kLowest); }

#endif
