// Samples that are no light: who found them, and what was wrong with them.
#ifndef HELIO_SHARED_FAULTS_H
#define HELIO_SHARED_FAULTS_H
#include "shared/types.h"

HELIO_SHARED_BEGIN

HELIO_CONSTANT kFaultPrimary = 0u;     // what the camera sees has no position or no normal
HELIO_CONSTANT kFaultPathTrace = 1u;   // a path's radiance
HELIO_CONSTANT kFaultAccumulate = 2u;  // the mean of the samples before
HELIO_CONSTANT kFaultPasses = 3u;

HELIO_CONSTANT kFaultNan = 0u;
HELIO_CONSTANT kFaultInfinite = 1u;
HELIO_CONSTANT kFaultNegative = 2u;
HELIO_CONSTANT kFaultCauses = 3u;
HELIO_CONSTANT kNoFault = 3u;

HELIO_CONSTANT kFaultKinds = 9u;  // pass * kFaultCauses + cause
HELIO_CONSTANT kFaultVertexBits = 6u;

// Of one tick; all zero: nothing was dropped. What says where is inverted, so that the least place has the largest
// value.
struct Faults {
  uint counts[kFaultKinds];
  uint first_sample;         // ~SampleConstants.sample_index of the first sample with a fault
  uint seed;                 // SampleConstants.seed of that sample
  uint places[kFaultKinds];  // ~(pixel << kFaultVertexBits | vertex), the first pixel of that sample
};

HELIO_SHARED_END
#endif
