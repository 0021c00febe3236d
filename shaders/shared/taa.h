// What temporal anti-aliasing is told.
#ifndef HELIO_SHARED_TAA_H
#define HELIO_SHARED_TAA_H
#include "shared/types.h"

HELIO_SHARED_BEGIN

struct TaaConstants {
  uint64_t frame;  // FrameConstants
  uint mean;       // rg32ui: packHalf4() of the mean over the ticks before, times the unit; a: ticks in it
  uint resolved;   // rg32ui: with this tick, before it takes the mean's place
};

HELIO_SHARED_END
#endif
