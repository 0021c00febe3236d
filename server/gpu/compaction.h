// Compaction: a structure that will not change needs less memory than its build did.
#pragma once

#include <span>

#include "gpu/acceleration_structure.h"

namespace helio::gpu {

struct Compaction {
  uint64_t before = 0;  ///< bytes of all structures
  uint64_t after = 0;
};

/// Copies each structure that was built by buildBlases() to one of its compacted size, where that is smaller by a
/// twentieth at least; addresses change. Records, submits and waits: their builds must be done.
Compaction compact(Commands& commands, std::span<AccelerationStructure> structures);

}  // namespace helio::gpu
