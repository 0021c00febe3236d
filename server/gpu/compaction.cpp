#include "gpu/compaction.h"

namespace helio::gpu {
namespace {
constexpr uint64_t kWorthwhile = 20;  // a saving of 1 / 20 is
}

CompactionQuery::CompactionQuery(Commands& commands, std::span<const VkAccelerationStructureKHR> structures)
    : device_(&commands.device()), count_(static_cast<uint32_t>(structures.size())) {
  VkQueryPoolCreateInfo info{VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO};
  info.queryType = VK_QUERY_TYPE_ACCELERATION_STRUCTURE_COMPACTED_SIZE_KHR;
  info.queryCount = count_;
  check(vkCreateQueryPool(device_->handle(), &info, nullptr, &pool_), "a pool of compacted sizes");
  commands.barrier(use::build_write, use::build_read);
  vkCmdResetQueryPool(commands.handle(), pool_, 0, count_);
  vkCmdWriteAccelerationStructuresPropertiesKHR(commands.handle(), count_, structures.data(), info.queryType, pool_, 0);
}

CompactionQuery::~CompactionQuery() {
  if (pool_) vkDestroyQueryPool(device_->handle(), pool_, nullptr);
}

void CompactionQuery::swap(CompactionQuery& other) noexcept {
  std::swap(device_, other.device_);
  std::swap(pool_, other.pool_);
  std::swap(count_, other.count_);
}

std::vector<uint64_t> CompactionQuery::sizes() const {
  std::vector<uint64_t> sizes(count_);
  check(vkGetQueryPoolResults(device_->handle(), pool_, 0, count_, count_ * sizeof(uint64_t), sizes.data(),
                              sizeof(uint64_t), VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT),
        "reading compacted sizes");
  return sizes;
}

bool worthCompacting(uint64_t size, uint64_t compacted) {
  return compacted > 0 && compacted + size / kWorthwhile <= size;
}

void copyCompacted(Commands& commands, VkAccelerationStructureKHR from, VkAccelerationStructureKHR to) {
  VkCopyAccelerationStructureInfoKHR copy{VK_STRUCTURE_TYPE_COPY_ACCELERATION_STRUCTURE_INFO_KHR};
  copy.src = from;
  copy.dst = to;
  copy.mode = VK_COPY_ACCELERATION_STRUCTURE_MODE_COMPACT_KHR;
  vkCmdCopyAccelerationStructureKHR(commands.handle(), &copy);
}

Compaction compact(Commands& commands, std::span<AccelerationStructure> structures) {
  Compaction result;
  if (structures.empty()) return result;
  std::vector<VkAccelerationStructureKHR> handles;
  for (const AccelerationStructure& structure : structures) handles.push_back(structure.handle());
  commands.begin();
  const CompactionQuery query(commands, handles);
  commands.submit();
  (void)commands.finish();
  const std::vector<uint64_t> sizes = query.sizes();

  std::vector<AccelerationStructure> compacted(structures.size());
  commands.begin();
  for (size_t i = 0; i < structures.size(); ++i) {
    const uint64_t size = structures[i].size();
    result.before += size;
    const bool worth = worthCompacting(size, sizes[i]);
    result.after += worth ? sizes[i] : size;
    if (!worth) continue;
    compacted[i] = AccelerationStructure(commands.device(), "a compacted BLAS",
                                         VK_ACCELERATION_STRUCTURE_TYPE_BOTTOM_LEVEL_KHR, sizes[i]);
    copyCompacted(commands, handles[i], compacted[i].handle());
  }
  commands.submit();
  (void)commands.finish();
  for (size_t i = 0; i < structures.size(); ++i)
    if (compacted[i]) structures[i] = std::move(compacted[i]);
  return result;
}

}  // namespace helio::gpu
