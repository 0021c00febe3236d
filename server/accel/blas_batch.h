// The BLASes that one tick builds and refits: whoever wants some adds them, within one budget, and all go into one
// call.
#pragma once

#include <limits>
#include <vector>

#include "gpu/acceleration_structure.h"

namespace helio::accel {

/// What one tick may build anew, for what has no BLAS yet or to switch its level of detail; refits have no budget.
/// Counts, not times: the same world gives the same ticks.
struct BuildBudget {
  uint32_t builds = 1024;
  uint64_t triangles = 1'000'000;

  static BuildBudget unlimited() {
    return {std::numeric_limits<uint32_t>::max(), std::numeric_limits<uint64_t>::max()};
  }
};

class BlasBatch {
 public:
  static constexpr uint32_t kScratchKept = 60;  ///< ticks without a build after which scratch memory is given back

  explicit BlasBatch(gpu::Device& device) : device_(device) {}

  /// A new tick. Nothing submitted may be running.
  void begin(const BuildBudget& budget);
  bool affords(uint64_t triangles) const { return left_.builds > 0 && left_.triangles >= triangles; }
  /// Nothing has been spent, so that what is larger than the whole budget gets its turn as well.
  bool untouched() const { return untouched_ && left_.builds > 0; }
  void spend(uint64_t triangles);

  void add(gpu::BlasUpdate update, uint64_t scratch);
  bool empty() const { return updates_.empty(); }
  /// Records all of them.
  void record(gpu::Commands& commands);
  /// False: one call a BLAS instead, with a barrier behind each, to measure what the batch saves.
  void setOneCall(bool one_call) { one_call_ = one_call; }

  uint64_t scratchBytes() const { return scratch_ ? scratch_.size() : 0; }
  uint64_t cpuBytes() const {
    return updates_.capacity() * sizeof(gpu::BlasUpdate) + scratch_sizes_.capacity() * sizeof(uint64_t);
  }

 private:
  gpu::Device& device_;
  BuildBudget left_;
  bool untouched_ = true;
  bool one_call_ = true;
  uint32_t idle_ticks_ = 0;
  std::vector<gpu::BlasUpdate> updates_;
  std::vector<uint64_t> scratch_sizes_;
  gpu::Buffer scratch_;
};

}  // namespace helio::accel
