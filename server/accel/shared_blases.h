// BLASes that instances share, one a mesh and level of detail: a cache. One is built when an instance that needs it is
// to enter the TLAS, kept while rays meet it, and given back when nobody has needed it for a while or when others need
// its memory [Kelling §3.3.1].
#pragma once

#include <string>
#include <vector>

#include "accel/blas_batch.h"
#include "accel/shared_blas_settings.h"
#include "gpu/compaction.h"
#include "shared/scene.h"

namespace helio::accel {

/// A mesh at one of its levels of detail.
struct SharedShape {
  std::string name;
  uint32_t mesh = 0;
  std::vector<gpu::BlasGeometry> geometries;  ///< empty: every instance has a BLAS of its own
  uint64_t triangles = 0;
};

struct SharedBlasFigures {
  uint32_t resident = 0;
  uint32_t waiting = 0;  ///< needed, and kept out by a budget
  uint32_t built = 0;    ///< in this tick
  uint32_t evicted = 0;
  uint64_t triangles = 0;  ///< built in this tick
};

/// Who needs what is known where the TLAS is assembled, on the GPU: it notes for every record of the mesh table how
/// much it is needed, and the CPU reads that one tick later. Until a BLAS is there its mesh's next finer level that has
/// one stands in for it, or else the next coarser; where there is none, its instances are not in the TLAS.
/// Deterministic: budgets count, and order is by need, then by record.
class SharedBlases {
 public:
  /// `records`: the mesh table, one entry a mesh, and its coarser levels behind them (shared/scene.h); `shapes`: as
  /// they are. Waits for nothing.
  SharedBlases(gpu::Device& device, std::vector<shared::MeshRecord> records, std::vector<SharedShape> shapes);

  void set(const SharedBlasSettings& settings) { settings_ = settings; }
  /// The record of the mesh table that an instance asks for.
  uint32_t recordOf(const shared::InstanceRecord& instance) const;

  /// An instance comes whose BLAS must be there in this very tick. Before plan().
  void want(uint32_t record);
  /// Decides what this tick builds, as far as budgets go, and what it gives back. Nothing submitted may be running.
  void plan(uint64_t tick, BlasBatch& batch);
  /// Everything is there, at once and whatever it takes: builds what is missing, compacts, submits and waits.
  void planAll(uint64_t tick, gpu::Commands& commands);
  /// After a tick that failed: what it built was never built.
  void forget();

  /// The mesh table changed since the last upload(), so that the TLAS must be assembled anew.
  bool dirty() const { return dirty_; }
  /// By this tick: rays may meet what they did not meet before.
  bool grew() const { return grew_; }
  bool hasWork() const { return !pending_.empty() || !copies_.empty(); }
  /// Records the copies (transfer writes).
  void upload(gpu::Commands& commands);
  /// Behind the batch's builds: copies to compacted sizes, and asks for those of what was built.
  void record(gpu::Commands& commands);
  /// Copies what the assembly noted to where plan() reads it.
  void readBack(gpu::Commands& commands);

  /// MeshRecord a record: of what rays meet in its place, with `blas`.
  VkDeviceAddress table() const { return table_.address(); }
  const gpu::Buffer& tableBuffer() const { return table_; }
  /// uint a record: how much it is needed, to be raised by atomicMax; 0: nobody asks (planAll).
  VkDeviceAddress needs() const { return everything_ ? 0 : needs_.address(); }

  const SharedBlasFigures& figures() const { return figures_; }
  bool resident(uint32_t record) const { return static_cast<bool>(entries_[record].blas); }
  uint64_t bytes() const;            ///< of all structures
  uint64_t compactionSaved() const;  ///< bytes that they would need more
  uint64_t tableBytes() const { return table_.size() + needs_.size(); }

 private:
  struct Entry {
    gpu::AccelerationStructure blas;
    gpu::BlasSizes sizes;
    uint64_t used_at = 0;  // tick
    uint64_t saved = 0;    // bytes, by compaction
    bool fresh = false;    // built or copied by this tick
  };
  struct Copy {
    VkAccelerationStructureKHR from, to;
  };
  void beginTick();
  void readNeeds();
  void compactLast();
  /// The record that rays meet in place of this one: itself where it is resident, or nothing of its mesh is.
  uint32_t standIn(uint32_t record) const;
  /// Makes room for so many bytes by what nobody needs, the oldest first. False: there is too little of that.
  bool makeRoom(uint64_t bytes, uint64_t tick);
  void evict(uint32_t record);

  gpu::Device& device_;
  SharedBlasSettings settings_;
  std::vector<shared::MeshRecord> records_;
  std::vector<SharedShape> shapes_;
  std::vector<std::vector<uint32_t>> levels_;  // by mesh: its records, the finest first
  std::vector<Entry> entries_;                 // by record
  SharedBlasFigures figures_;

  bool everything_ = false;
  std::vector<uint32_t> need_;      // by record, as of the last news; 0: none
  bool asked_ = false;              // there is news to read
  std::vector<uint32_t> arriving_;  // records that want() named since the last plan()
  std::vector<uint32_t> pending_;   // records that this tick builds
  std::vector<Copy> copies_;
  std::vector<gpu::AccelerationStructure> retired_;  // copied by this tick
  gpu::CompactionQuery query_;
  std::vector<uint32_t> asked_sizes_;  // records that query_ asked about
  bool dirty_ = true, grew_ = false;
  gpu::Buffer table_, needs_, needs_readback_;
};

}  // namespace helio::accel
