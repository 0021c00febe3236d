#include "accel/tlas_assembly.h"

#include <algorithm>

#include "shared/assemble.h"

namespace helio::accel {
namespace {
static_assert(sizeof(shared::TlasInstance) == sizeof(VkAccelerationStructureInstanceKHR));

/// Buckets are 1/4 of a power of two apart.
uint32_t bucketAbove(uint32_t count) {
  uint32_t step = 64;
  while (step * 8 < count) step *= 2;
  return std::max(step, (count + step - 1) / step * step);
}
}  // namespace

TlasAssembly::TlasAssembly(gpu::Device& device) : device_(device), pipeline_(device, "assemble/assemble.comp") {}

void TlasAssembly::reserve(gpu::Commands& commands, uint32_t count) {
  if (count <= capacity_ && capacity_ <= 2 * bucketAbove(count + count / 4)) return;
  const uint32_t capacity = bucketAbove(count + count / 4);
  gpu::Buffer instances(
      device_, {"the TLAS instances", capacity * sizeof(shared::TlasInstance), gpu::MemoryCategory::ray_tracing,
                gpu::Placement::device, VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_BUILD_INPUT_READ_ONLY_BIT_KHR});
  if (instances_) commands.retire(std::move(instances_));
  instances_ = std::move(instances);
  capacity_ = capacity;
}

void TlasAssembly::assemble(gpu::Commands& commands, const InstanceTable& table, VkDeviceAddress meshes) {
  shared::AssembleConstants constants{};
  constants.order = table.orderBuffer().address();
  constants.instances = table.recordBuffer().address();
  constants.meshes = meshes;
  constants.output_ = instances_.address();
  constants.count = static_cast<uint32_t>(table.order().size());
  constants.capacity = capacity_;
  commands.bind(pipeline_);
  commands.push(constants);
  commands.dispatch((capacity_ + 63) / 64);
}

void TlasAssembly::build(gpu::Commands& commands) { tlas_.build(commands, instances_.address(), capacity_); }

}  // namespace helio::accel
