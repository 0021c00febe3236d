// What a pass that filters a view's light is told.
#ifndef HELIO_SHARED_FILTER_H
#define HELIO_SHARED_FILTER_H
#include "shared/types.h"

HELIO_SHARED_BEGIN

struct FilterConstants {
  uint64_t frame;  // FrameConstants
  // Images: rgba16f, diffuse and specular.
  uint source[2];
  uint target[2];
  uint stride;       // pixels between taps
  uint accumulated;  // samples in the mean of a picture that stands still
  uint mean;         // rgba32f: that mean
};

HELIO_SHARED_END
#endif
