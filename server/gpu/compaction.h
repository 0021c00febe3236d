// Compaction: a structure that will not change needs less memory than its build did.
#pragma once

#include <span>

#include "gpu/acceleration_structure.h"

namespace helio::gpu {

/// Asks in one frame how small structures can become, and knows it in the next.
class CompactionQuery {
 public:
  CompactionQuery() = default;
  CompactionQuery(CompactionQuery&& other) noexcept { swap(other); }
  CompactionQuery& operator=(CompactionQuery&& other) noexcept {
    CompactionQuery(std::move(other)).swap(*this);
    return *this;
  }
  ~CompactionQuery();

  /// Records the question. The structures' builds (BlasKind::still) were recorded before, or are done.
  CompactionQuery(Commands& commands, std::span<const VkAccelerationStructureKHR> structures);
  explicit operator bool() const { return pool_ != VK_NULL_HANDLE; }
  /// Bytes, in the order of the question. After the commands are done.
  std::vector<uint64_t> sizes() const;

 private:
  void swap(CompactionQuery& other) noexcept;
  Device* device_ = nullptr;
  VkQueryPool pool_ = VK_NULL_HANDLE;
  uint32_t count_ = 0;
};

/// Whether a structure of `size` bytes is worth a copy of `compacted` ones: it saves a twentieth at least.
bool worthCompacting(uint64_t size, uint64_t compacted);
/// Records the copy of a structure whose build is done to one of its compacted size.
void copyCompacted(Commands& commands, VkAccelerationStructureKHR from, VkAccelerationStructureKHR to);

struct Compaction {
  uint64_t before = 0;  ///< bytes of all structures
  uint64_t after = 0;
};

/// Copies each structure that was built by buildBlases() to one of its compacted size, where that is worth it;
/// addresses change. Records, submits and waits: their builds must be done.
Compaction compact(Commands& commands, std::span<AccelerationStructure> structures);

}  // namespace helio::gpu
