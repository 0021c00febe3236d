// BLASes of instances' own: what deforms cannot share one. Built within a budget, refitted in every tick that they are
// traced in, rebuilt in turn, given back when nobody has wanted them for a while [Kelling §3.3.1].
#pragma once

#include <span>
#include <vector>

#include "accel/blas_batch.h"
#include "accel/units.h"
#include "gpu/range_pool.h"

namespace helio::accel {

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

  /// Decides what this tick builds and refits, as far as the batch's budget goes: `wanted` are units that deform, the
  /// most important first. `moved`: poses changed since the last tick. A unit whose BLAS does not have this tick's pose
  /// is left out of the TLAS; one that the budget keeps from switching its level stays at the one that it has.
  void plan(std::span<const WantedUnit> wanted, Units& units, InstanceTable& table, uint64_t tick, bool moved,
            BlasBatch& batch);
  /// The level of detail that a unit's BLAS has; 0 where there is none.
  uint32_t level(uint32_t unit) const { return unit < structures_.size() ? structures_[unit].level : 0; }
  /// The unit is no more. Not while submitted work uses its BLAS.
  void release(uint32_t unit);
  /// After a tick that failed: nothing counts as built.
  void forget();

  bool hasWork() const { return !deform_jobs_.empty(); }
  /// Records the copies of what deform() reads (transfer writes).
  void upload(gpu::Commands& commands);
  /// Compute: the vertices of all that is built or refitted. After the units' poses.
  void deform(gpu::Commands& commands, const InstanceTable& table) const;

  const OwnBlasFigures& figures() const { return figures_; }
  bool inTlas(uint32_t unit) const { return unit < structures_.size() && structures_[unit].in_tlas; }
  uint64_t structureBytes() const { return structures_pool_.bytesHeld(); }
  uint64_t vertexBytes() const { return vertices_pool_.bytesHeld(); }
  uint64_t cpuBytes() const {
    return structures_.capacity() * sizeof(Structure) + held_.capacity() * sizeof(uint32_t) +
           deform_jobs_.capacity() * sizeof(shared::DeformJob);
  }

 private:
  struct Structure {
    gpu::Range vertices, storage;
    gpu::AccelerationStructure blas;
    bool built = false;
    bool in_tlas = false;
    uint32_t level = 0;
    uint64_t wanted_at = 0;  // tick
  };

  gpu::Device& device_;
  gpu::RangePool vertices_pool_, structures_pool_;
  std::vector<Structure> structures_;  // by unit
  std::vector<uint32_t> held_;         // units that have one; and until the next plan() some that had
  OwnBlasFigures figures_;

  // Of this tick.
  std::vector<shared::DeformJob> deform_jobs_;
  uint32_t most_vertices_ = 0;
  gpu::Buffer job_buffer_;
  gpu::ComputePipeline deform_;
};

}  // namespace helio::accel
