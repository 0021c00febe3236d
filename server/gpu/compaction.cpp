#include "gpu/compaction.h"

namespace helio::gpu {
namespace {

constexpr uint64_t kWorthwhile = 20;  // a saving of 1 / 20 is

/// Compacted sizes, in order.
std::vector<uint64_t> compactedSizes(Commands& commands, std::span<const AccelerationStructure> structures) {
  Device& device = commands.device();
  const auto count = static_cast<uint32_t>(structures.size());
  VkQueryPoolCreateInfo info{VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO};
  info.queryType = VK_QUERY_TYPE_ACCELERATION_STRUCTURE_COMPACTED_SIZE_KHR;
  info.queryCount = count;
  struct Pool {
    VkDevice device;
    VkQueryPool handle = VK_NULL_HANDLE;
    ~Pool() { vkDestroyQueryPool(device, handle, nullptr); }
  } pool{device.handle()};
  check(vkCreateQueryPool(device.handle(), &info, nullptr, &pool.handle), "a pool of compacted sizes");
  std::vector<VkAccelerationStructureKHR> handles;
  for (const AccelerationStructure& structure : structures) handles.push_back(structure.handle());
  commands.begin();
  vkCmdResetQueryPool(commands.handle(), pool.handle, 0, count);
  vkCmdWriteAccelerationStructuresPropertiesKHR(commands.handle(), count, handles.data(), info.queryType, pool.handle,
                                                0);
  commands.submit();
  (void)commands.finish();
  std::vector<uint64_t> sizes(count);
  check(vkGetQueryPoolResults(device.handle(), pool.handle, 0, count, count * sizeof(uint64_t), sizes.data(),
                              sizeof(uint64_t), VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT),
        "reading compacted sizes");
  return sizes;
}

}  // namespace

Compaction compact(Commands& commands, std::span<AccelerationStructure> structures) {
  Compaction result;
  if (structures.empty()) return result;
  const std::vector<uint64_t> sizes = compactedSizes(commands, structures);
  std::vector<AccelerationStructure> compacted(structures.size());
  commands.begin();
  for (size_t i = 0; i < structures.size(); ++i) {
    const uint64_t size = structures[i].size();
    result.before += size;
    if (sizes[i] == 0 || sizes[i] + size / kWorthwhile > size) {
      result.after += size;
      continue;
    }
    result.after += sizes[i];
    compacted[i] = AccelerationStructure(commands.device(), "a compacted BLAS",
                                         VK_ACCELERATION_STRUCTURE_TYPE_BOTTOM_LEVEL_KHR, sizes[i]);
    VkCopyAccelerationStructureInfoKHR copy{VK_STRUCTURE_TYPE_COPY_ACCELERATION_STRUCTURE_INFO_KHR};
    copy.src = structures[i].handle();
    copy.dst = compacted[i].handle();
    copy.mode = VK_COPY_ACCELERATION_STRUCTURE_MODE_COMPACT_KHR;
    vkCmdCopyAccelerationStructureKHR(commands.handle(), &copy);
  }
  commands.submit();
  (void)commands.finish();
  for (size_t i = 0; i < structures.size(); ++i)
    if (compacted[i]) structures[i] = std::move(compacted[i]);
  return result;
}

}  // namespace helio::gpu
