#include "accel/blas_batch.h"

#include <algorithm>

namespace helio::accel {

void BlasBatch::begin(const BuildBudget& budget) {
  left_ = budget;
  untouched_ = true;
  idle_ticks_ = updates_.empty() ? idle_ticks_ + 1 : 0;
  if (idle_ticks_ > kScratchKept) scratch_ = {};
  updates_.clear();
  scratch_sizes_.clear();
}

void BlasBatch::spend(uint64_t triangles) {
  --left_.builds;
  left_.triangles -= std::min(left_.triangles, triangles);
  untouched_ = false;
}

void BlasBatch::add(gpu::BlasUpdate update, uint64_t scratch) {
  updates_.push_back(std::move(update));
  scratch_sizes_.push_back(scratch);
}

void BlasBatch::record(gpu::Commands& commands) {
  if (updates_.empty()) return;
  const uint64_t scratch = gpu::scratchFor(device_, scratch_sizes_);
  if (scratch_.size() < scratch || scratch_.size() > 4 * scratch) {
    if (scratch_) commands.retire(std::move(scratch_));
    scratch_ =
        gpu::Buffer(device_, {"the scratch memory of BLASes", scratch + scratch / 4, gpu::MemoryCategory::ray_tracing});
  }
  gpu::updateBlases(commands, updates_, scratch_sizes_, scratch_, one_call_);
}

}  // namespace helio::accel
