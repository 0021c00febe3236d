// Further paths of a tick, where what is known of the light is young and noisy: which pixels get how many of them.
#ifndef HELIO_SHARED_EXTRA_SAMPLES_H
#define HELIO_SHARED_EXTRA_SAMPLES_H
#include "shared/paths.h"

HELIO_SHARED_BEGIN

HELIO_CONSTANT kMostExtraPaths = 4u;  // of a pixel in a tick: so many rounds trace them, a path a pixel each
HELIO_CONSTANT kExtraTile = 8u;       // pixels along a side of a tile, whose noise is measured as one
HELIO_CONSTANT kYoungTicks = 4u;      // a history of fewer ticks is young

// Noise in steps of a quarter of an octave of the relative standard deviation. Bin 0: there is none.
HELIO_CONSTANT kNoiseBins = 64u;
HELIO_CONSTANT kNoiseStepsPerOctave = 4u;
HELIO_CONSTANT kNoiseOctavesBelowOne = 8u;

// Of a tile. Pixels are of two kinds, as the squares of a chess-board. How many paths a pixel gets depends on what the
// other kind's samples were, and never on its own: else bright samples would call for more paths, and the mean with
// these be too dark [Kirk and Arvo 1991, Unbiased sampling techniques for image synthesis].
struct ExtraTile {
  uint noise;     // bins: of pixels of the first kind in bits 0 to 7, of the second in bits 8 to 15
  uint young[2];  // a bit a pixel, row by row
};

// Of a view in a tick.
struct ExtraSamples {
  PathLaunch rounds[kMostExtraPaths];  // the pixels that get a first further path, a second one, ...
  PathLaunch listing;                  // of the pass that lists them
  uint wanted[kMostExtraPaths + 1];    // pixels that get so many paths
  uint listed[kMostExtraPaths + 1];    // those of them that are in the list already
  float share;                         // paths a pixel and deviation, the first one counted
  uint young[kNoiseBins];              // young pixels by the noise around them
};

// In path_info, between the choice and the list.
HELIO_CONSTANT kExtraPathsShift = 24u;
HELIO_CONSTANT kExtraPathsMask = 7u;

HELIO_SHARED_END
#endif
