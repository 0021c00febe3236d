// BLASes of instances' own: what deforms cannot share one. Built within a budget, refitted in every tick that they are
// traced in, rebuilt in turn, given back when nobody has wanted them for a while [Kelling §3.3.1].
#pragma once

#include <span>
#include <vector>

#include "accel/units.h"
#include "gpu/acceleration_structure.h"
#include "gpu/range_pool.h"

namespace helio::accel {

/// What one tick may build anew, for a unit that has none yet or to switch its level of detail; refits have no budget.
/// Counts, not times: the same world gives the same ticks.
struct BuildBudget {
  uint32_t builds = 1024;
  uint64_t triangles = 1'000'000;
};

/// A unit that rays should meet, and at which level of detail of its mesh.
struct WantedUnit {
  uint32_t unit;
  uint32_t level;
};

struct OwnBlasFigures {
  uint32_t in_tlas = 0;
  uint32_t waiting = 0;  ///< wanted, left to a later tick by the budget
  uint32_t built = 0;    ///< in this tick, rebuilds too
  uint32_t refitted = 0;
  uint64_t triangles = 0;  ///< built or refitted
};

class OwnBlases {
 public:
  static constexpr uint32_t kRebuildEvery = 16;  ///< ticks: refits alone let a BLAS decay
  static constexpr uint32_t kAgeLimit = 60;      ///< ticks that an unwanted BLAS is kept

  explicit OwnBlases(gpu::Device& device);

  /// Decides what this tick builds and refits: `wanted` are units that deform, the most important first. `moved`: poses
  /// changed since the last tick. `all`: no budget, nothing waits. A unit whose BLAS does not have this tick's pose is
  /// left out of the TLAS; one that the budget keeps from switching its level stays at the one that it has.
  void plan(std::span<const WantedUnit> wanted, Units& units, InstanceTable& table, uint64_t tick, bool moved,
            bool all);
  /// The level of detail that a unit's BLAS has; 0 where there is none.
  uint32_t level(uint32_t unit) const { return unit < structures_.size() ? structures_[unit].level : 0; }
  /// The unit is no more. Not while submitted work uses its BLAS.
  void release(uint32_t unit);
  /// After a tick that failed: nothing counts as built.
  void forget();

  bool hasWork() const { return !jobs_.empty(); }
  /// Records the copies of what deform() reads (transfer writes).
  void upload(gpu::Commands& commands);
  /// Compute: the vertices of all that is built or refitted. After the units' poses.
  void deform(gpu::Commands& commands, const InstanceTable& table) const;
  /// All builds and refits in one call.
  void build(gpu::Commands& commands);
  /// One call a BLAS instead, with a barrier behind each: what the batch saves.
  void setOneCall(bool one_call) { one_call_ = one_call; }
  void setBudget(const BuildBudget& budget) { budget_ = budget; }

  const OwnBlasFigures& figures() const { return figures_; }
  bool inTlas(uint32_t unit) const { return unit < structures_.size() && structures_[unit].in_tlas; }
  uint64_t structureBytes() const { return structures_pool_.bytesHeld(); }
  uint64_t vertexBytes() const { return vertices_pool_.bytesHeld(); }
  uint64_t cpuBytes() const {
    return structures_.capacity() * sizeof(Structure) + held_.capacity() * sizeof(uint32_t) +
           jobs_.capacity() * sizeof(Job) + deform_jobs_.capacity() * sizeof(shared::DeformJob) +
           updates_.capacity() * sizeof(gpu::BlasUpdate) + scratch_sizes_.capacity() * sizeof(uint64_t);
  }
  uint64_t scratchBytes() const { return scratch_ ? scratch_.size() : 0; }

 private:
  struct Structure {
    gpu::Range vertices, storage;
    gpu::AccelerationStructure blas;
    bool built = false;
    bool in_tlas = false;
    uint32_t level = 0;
    uint64_t wanted_at = 0;  // tick
  };
  struct Job {
    uint32_t unit;
    bool refit;
  };

  gpu::Device& device_;
  BuildBudget budget_;
  bool one_call_ = true;
  gpu::RangePool vertices_pool_, structures_pool_;
  std::vector<Structure> structures_;  // by unit
  std::vector<uint32_t> held_;         // units that have one; and until the next plan() some that had
  OwnBlasFigures figures_;

  // Of this tick.
  std::vector<Job> jobs_;
  std::vector<shared::DeformJob> deform_jobs_;
  std::vector<gpu::BlasUpdate> updates_;
  std::vector<uint64_t> scratch_sizes_;
  uint32_t most_vertices_ = 0;
  gpu::Buffer job_buffer_, scratch_;
  gpu::ComputePipeline deform_;
};

}  // namespace helio::accel
