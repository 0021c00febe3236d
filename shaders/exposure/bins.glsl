#ifndef HELIO_BINS_GLSL
#define HELIO_BINS_GLSL
#include "shared/frame.h"

const float kLowest = -16.0;   // log2 of radiance
const float kHighest = 16.0;

uint binOf(float luminance) {
  if (!(luminance > exp2(kLowest))) return 0u;
  const float t = (log2(luminance) - kLowest) / (kHighest - kLowest);
  return 1u + min(uint(t * float(kHistogramBins - 1u)), kHistogramBins - 2u);
}
// log2 luminance in the middle of a bin > 0.
float logLuminanceOf(uint bin) { return kLowest + (float(bin) - 0.5) / float(kHistogramBins - 1u) * (kHighest - kLowest); }

#endif
