// Lists of lamps that learn from shadow rays: which of a cell's lamps are seen from it [Lipp 2021, section 4.3, where a
// precomputed visibility knows it].
#ifndef HELIO_SHARED_LIGHT_LISTS_H
#define HELIO_SHARED_LIGHT_LISTS_H
#include "shared/scene.h"

HELIO_SHARED_BEGIN

// Of one cell, in the order of its LightCell's slots.
struct LightMemory {
  float weights[kLightsPerCell];  // power over squared distance, as if nothing stood in the way
  uint tried[kLightsPerCell];     // shadow rays to the lamp
  uint seen[kLightsPerCell];      // those of them that arrived
  uint candidate;                 // a lamp beyond the list that was seen: packCandidate(); 0: none
};

// The pass that learns: a thread a cell.
struct LightListConstants {
  uint64_t fixed_cells;  // LightCell, as the lamps' powers and distances say
  uint64_t learned;      // LightCell
  uint64_t memories;     // LightMemory
  uint cells;
  uint reset;  // 1: nothing has been learned yet
};

HELIO_SHARED_END
#endif
