// The cache of BLASes that instances share: what a world may choose.
#pragma once

#include <cstdint>

namespace helio::accel {

struct SharedBlasSettings {
  uint64_t memory = 512u << 20;  ///< bytes, at most; what everything needs at once (full, reference) is not held to it
  uint32_t age_limit = 60;       ///< ticks that an unused one is kept, [1, 1,000,000]
};

}  // namespace helio::accel
