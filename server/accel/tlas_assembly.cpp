#include "accel/tlas_assembly.h"

#include <algorithm>
#include <cstring>

#include "shared/assemble.h"

namespace helio::accel {
namespace {
static_assert(sizeof(shared::TlasInstance) == sizeof(VkAccelerationStructureInstanceKHR));

/// Ticks for which a smaller bucket must do before a little is given back; much is given back at once.
constexpr uint32_t kPatience = 20;

/// Buckets are 1/16 to 1/8 of the count apart.
uint32_t bucketAbove(uint32_t count) {
  uint32_t step = 64;
  while (step * 16 < count) step *= 2;
  return std::max(step, (count + step - 1) / step * step);
}
}  // namespace

TlasAssembly::TlasAssembly(gpu::Device& device, gpu::Commands& commands, const scene::Scene& scene)
    : device_(device),
      pipeline_(device, "assemble/assemble.comp"),
      counter_(device, {"the count of TLAS instances", sizeof(uint32_t), gpu::MemoryCategory::ray_tracing}),
      counter_readback_(device, {"the count of TLAS instances, read back", sizeof(uint32_t),
                                 gpu::MemoryCategory::transfer, gpu::Placement::readback}) {
  std::vector<glm::vec4> spheres;
  for (const scene::Mesh& mesh : scene.meshes)
    spheres.emplace_back(mesh.bounds.centre(), 0.5f * glm::length(mesh.bounds.extent()));
  spheres_ = gpu::Buffer(
      device, {"bounding spheres of meshes", spheres.size() * sizeof(glm::vec4), gpu::MemoryCategory::ray_tracing});
  commands.begin();
  commands.upload<glm::vec4>(spheres_, 0, spheres);
  commands.submit();
  (void)commands.finish();
  std::memset(counter_readback_.mapped(), 0, sizeof(uint32_t));
}

void TlasAssembly::reserve(gpu::Commands& commands, const InstanceTable& table, const CullingStrategy& strategy) {
  const std::vector<shared::CullVolume>* volumes = strategy.volumes();
  culls_ = all_blocks_ = false;
  chosen_.clear();
  if (volumes != nullptr) {
    culls_ = true;
    volumes_ = *volumes;
    const std::vector<OrderBlock>& blocks = table.blocks();
    for (uint32_t b = 0; b < blocks.size(); ++b)
      if (strategy.wants(blocks[b].centre, blocks[b].radius)) chosen_.push_back(b);
  } else {
    all_blocks_ = true;
    chosen_.resize(table.blocks().size());
  }
  const auto count = static_cast<uint32_t>(
      std::min(chosen_.size() * shared::kOrderBlock, gpu::alignUp(table.order().size(), size_t{shared::kOrderBlock})));
  reserve(commands, surfaces_, count);
  drop(commands, counted_);
  if (const uint64_t bytes = bucketAbove(static_cast<uint32_t>(table.records().size())) * sizeof(uint32_t);
      untraced_.size() < bytes) {
    if (untraced_) commands.retire(std::move(untraced_));
    untraced_ = gpu::Buffer(device_, {"what rays do not meet", bytes, gpu::MemoryCategory::ray_tracing});
  }
  commands.fill(untraced_, 1);
}

void TlasAssembly::reserve(gpu::Commands& commands, const TlasRoom& room) {
  if (room.surfaces > 0) reserve(commands, surfaces_, room.surfaces);
  else drop(commands, surfaces_);
  reserve(commands, counted_, room.counted);
}

void TlasAssembly::drop(gpu::Commands& commands, Part& part) {
  if (part.instances) commands.retire(std::move(part.instances));
  part = {part.name};
}

void TlasAssembly::reserve(gpu::Commands& commands, Part& part, uint32_t count) {
  const uint32_t capacity = bucketAbove(count + count / 8);
  if (part.instances && count <= part.capacity) {
    part.roomy_ticks = capacity < part.capacity ? part.roomy_ticks + 1 : 0;
    const bool much = 8 * part.capacity > 9 * capacity;
    if (!much && part.roomy_ticks < kPatience) return;
  }
  part.roomy_ticks = 0;
  gpu::Buffer instances(device_,
                        {part.name, capacity * sizeof(shared::TlasInstance), gpu::MemoryCategory::ray_tracing,
                         gpu::Placement::device, VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_BUILD_INPUT_READ_ONLY_BIT_KHR});
  if (part.instances) commands.retire(std::move(part.instances));
  part.instances = std::move(instances);
  part.capacity = capacity;
}

void TlasAssembly::upload(gpu::Commands& commands) {
  commands.fill(counter_, 0);
  const auto store = [&](gpu::Buffer& buffer, const char* name, std::span<const std::byte> bytes) {
    if (buffer.size() < bytes.size()) {
      if (buffer) commands.retire(std::move(buffer));
      buffer = gpu::Buffer(device_, {name, bytes.size() * 3 / 2, gpu::MemoryCategory::ray_tracing});
    }
    if (!bytes.empty()) commands.upload(buffer, 0, bytes);
  };
  if (!all_blocks_) store(chosen_buffer_, "the blocks of the order", std::as_bytes(std::span(chosen_)));
  if (culls_) store(volume_buffer_, "what rays can meet", std::as_bytes(std::span(volumes_)));
}

void TlasAssembly::assemble(gpu::Commands& commands, const InstanceTable& table, const SharedBlases& blases) {
  shared::AssembleConstants constants{};
  constants.order = table.orderBuffer().address();
  constants.instances = table.recordBuffer().address();
  constants.meshes = blases.table();
  constants.needs = blases.needs();
  constants.output_ = surfaces_.instances.address();
  constants.blocks = all_blocks_ ? 0 : chosen_buffer_.address();
  constants.volumes = culls_ ? volume_buffer_.address() : 0;
  constants.spheres = spheres_.address();
  constants.entered = counter_.address();
  constants.untraced = untraced_.address();
  constants.count = static_cast<uint32_t>(table.order().size());
  constants.block_count = static_cast<uint32_t>(chosen_.size());
  constants.volume_count = static_cast<uint32_t>(volumes_.size());
  constants.capacity = surfaces_.capacity;
  commands.bind(pipeline_);
  commands.push(constants);
  commands.dispatch((surfaces_.capacity + shared::kOrderBlock - 1) / shared::kOrderBlock);
}

void TlasAssembly::build(gpu::Commands& commands) {
  commands.copy(counter_, counter_readback_, sizeof(uint32_t));
  commands.barrier(gpu::use::transfer_write, gpu::use::host_read);
  std::vector<gpu::TlasInput> inputs;
  for (Part* part : {&surfaces_, &counted_})
    if (part->capacity > 0) inputs.push_back({&part->tlas, part->instances.address(), part->capacity});
  gpu::buildTlases(commands, inputs);
}

uint32_t TlasAssembly::entered() const {
  counter_readback_.invalidate();
  uint32_t count = 0;
  std::memcpy(&count, counter_readback_.mapped(), sizeof count);
  return count;
}

}  // namespace helio::accel
