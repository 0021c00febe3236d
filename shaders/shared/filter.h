// What a pass that filters a view's light is told.
#ifndef HELIO_SHARED_FILTER_H
#define HELIO_SHARED_FILTER_H
#include "shared/types.h"

HELIO_SHARED_BEGIN

struct FilterConstants {
  uint64_t frame;  // FrameConstants
  // Images: packed light (rg32ui) and its deviations (rg16f), as history.h says.
  uint source;
  uint source_deviation;
  uint target;
  uint target_deviation;
  uint keeps;        // 1: the next tick goes on from the target
  uint stride;       // pixels between taps
  uint accumulated;  // samples in the mean of a picture that stands still
  uint mean;         // rgba32f: that mean
};

// What a pass of A-SVGF that estimates gradients is told (shared/gradients.h).
struct GradientConstants {
  uint64_t frame;  // FrameConstants
  uint keeps;      // 0: the next tick will shade nothing again
  uint seed;       // of the sample of this tick
  vec2 jitter;     // its position in the pixel
  uint iteration;  // of the filter
};

HELIO_SHARED_END
#endif
