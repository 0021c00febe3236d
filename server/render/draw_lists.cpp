#include "render/draw_lists.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "accel/strategy.h"
#include "render/camera_frame.h"

namespace helio::render {
namespace {

constexpr gpu::Use kCompute = gpu::use::compute_write;
static_assert(sizeof(shared::DrawCommand) == shared::kCommandBytes &&
              sizeof(shared::DrawCommand) == sizeof(VkDrawIndexedIndirectCommand));

}  // namespace

void DrawLists::reserve(gpu::Commands& commands, uint64_t work_bytes, uint64_t command_bytes) {
  gpu::Device& device = commands.device();
  const auto fit = [&](gpu::Buffer& buffer, const char* name, uint64_t bytes, VkBufferUsageFlags usage) {
    if (buffer && buffer.size() >= bytes && buffer.size() <= 4 * bytes + 65'536) return;
    if (buffer) commands.retire(std::move(buffer));
    buffer = gpu::Buffer(device, {name, bytes + bytes / 4, gpu::MemoryCategory::raster, gpu::Placement::device, usage});
  };
  fit(work_, "the draw lists", work_bytes, 0);
  fit(commands_, "the draw commands", command_bytes, VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT);
  const uint64_t volume_bytes = volume_count_ * sizeof(shared::DrawVolume);
  const uint64_t count_bytes = volume_count_ * sizeof(shared::DrawCounts);
  if (volumes_.size() < volume_bytes)
    volumes_ = gpu::Buffer(device, {"volumes to draw", volume_bytes, gpu::MemoryCategory::raster});
  if (counts_readback_.size() < count_bytes)
    counts_readback_ =
        gpu::Buffer(device, {"counts of draws", count_bytes, gpu::MemoryCategory::transfer, gpu::Placement::readback});
}

void DrawLists::cull(gpu::Commands& commands, const CullPipelines& pipelines, const SceneResources& scene,
                     const DrawTable& table, const accel::InstanceTable& instances,
                     std::span<const shared::DrawVolume> volumes, VkDeviceAddress filter) {
  volume_count_ = static_cast<uint32_t>(volumes.size());
  draws_ = scene.drawCount();
  indices_ = &scene.drawIndices();
  records_ = scene.drawRecords();
  solid_draws_ = scene.solidDraws();
  const uint64_t count = table.count(), groups = (count + shared::kCullGroup - 1) / shared::kCullGroup;
  const uint64_t keys_at = 0, slots_at = keys_at + 4 * count * volume_count_,
                 sums_at = slots_at + 4 * count * volume_count_,
                 ranges_at = sums_at + 4 * shared::kMostLevels * (groups + 1) * volume_count_,
                 work_end = ranges_at + sizeof(shared::DrawRange) * table.meshes() * volume_count_;
  counts_at_ = uint64_t{shared::kCommandTableBytes} * draws_ * volume_count_;
  reserve(commands, work_end, counts_at_ + sizeof(shared::DrawCounts) * volume_count_);
  slot_bytes_ = 4 * count;
  slots_ = work_.address() + slots_at;

  commands.upload<shared::DrawVolume>(volumes_, 0, volumes);
  vkCmdFillBuffer(commands.handle(), commands_.handle(), counts_at_, sizeof(shared::DrawCounts) * volume_count_, 0);
  commands.barrier(gpu::use::transfer_write, kCompute);

  shared::CullConstants constants{};
  constants.by_mesh = table.byMesh();
  constants.mesh_first = table.meshFirst();
  constants.instances = instances.recordBuffer().address();
  constants.meshes = scene.cullMeshes();
  constants.draws = scene.drawRecords();
  constants.volumes = volumes_.address();
  constants.filter_ = filter;
  constants.keys = work_.address() + keys_at;
  constants.sums = work_.address() + sums_at;
  constants.slots = slots_;
  constants.ranges = work_.address() + ranges_at;
  constants.commands = commands_.address();
  constants.count = static_cast<uint32_t>(count);
  constants.mesh_count = table.meshes();
  constants.draw_count = draws_;
  constants.solid_draws = solid_draws_;
  const auto run = [&](const gpu::ComputePipeline& pipeline, uint32_t groups_x) {
    commands.bind(pipeline);
    commands.push(constants);
    commands.dispatch(groups_x, volume_count_);
    commands.barrier(kCompute, kCompute);
  };
  run(pipelines.mark, static_cast<uint32_t>(groups));
  run(pipelines.scan, 1);
  run(pipelines.list, static_cast<uint32_t>(groups));
  run(pipelines.commands, 2);
}

void DrawLists::draw(gpu::Commands& commands, uint32_t volume, bool masks, shared::DrawConstants constants) const {
  const uint32_t first = masks ? solid_draws_ : 0, most = masks ? draws_ - solid_draws_ : solid_draws_;
  if (most == 0) return;
  const uint64_t table = uint64_t{shared::kCommandTableBytes} * draws_ * volume;
  constants.slots = slots_ + slot_bytes_ * volume;
  constants.draws = records_;
  constants.records = commands_.address() + table + sizeof(shared::DrawCommand) * draws_ + sizeof(uint32_t) * first;
  commands.push(constants);
  const uint64_t count_at = counts_at_ + sizeof(shared::DrawCounts) * volume +
                            (masks ? offsetof(shared::DrawCounts, masked) : offsetof(shared::DrawCounts, solid));
  vkCmdBindIndexBuffer(commands.handle(), indices_->handle(), 0, VK_INDEX_TYPE_UINT32);
  vkCmdDrawIndexedIndirectCount(commands.handle(), commands_.handle(), table + sizeof(shared::DrawCommand) * first,
                                commands_.handle(), count_at, most, sizeof(shared::DrawCommand));
}

void DrawLists::describe(uint32_t volume, shared::RasterConstants& constants) const {
  constants.slots = slots_ + slot_bytes_ * volume;
  constants.commands = commands_.address() + uint64_t{shared::kCommandTableBytes} * draws_ * volume;
  constants.counts = commands_.address() + counts_at_ + sizeof(shared::DrawCounts) * volume;
  constants.draws = records_;
  constants.indices = indices_->address();
  constants.draw_count = draws_;
  constants.solid_draws = solid_draws_;
}

void DrawLists::dispatchTriangles(gpu::Commands& commands, uint32_t volume, bool masks) const {
  commands.dispatchIndirect(commands_, counts_at_ + sizeof(shared::DrawCounts) * volume +
                                           (masks ? offsetof(shared::DrawCounts, masked_groups)
                                                  : offsetof(shared::DrawCounts, solid_groups)));
}

void DrawLists::readBack(gpu::Commands& commands) const {
  commands.copy(commands_, counts_readback_, sizeof(shared::DrawCounts) * volume_count_, counts_at_);
}

uint64_t DrawLists::triangles() const {
  if (!counts_readback_) return 0;
  counts_readback_.invalidate();
  std::vector<shared::DrawCounts> counts(volume_count_);
  std::memcpy(counts.data(), counts_readback_.mapped(), counts.size() * sizeof(shared::DrawCounts));
  uint64_t sum = 0;
  for (const shared::DrawCounts& c : counts) sum += c.triangles;
  return sum;
}

shared::DrawVolume cameraVolume(const scene::Camera& camera, uint32_t width, uint32_t height, float pixels) {
  const CameraFrame frame = cameraFrame(camera);
  const float aspect = static_cast<float>(width) / static_cast<float>(height);
  const shared::CullVolume frustum =
      accel::frustumOf(camera.position, frame.right, frame.up, frame.forward, frame.tangent, aspect);
  shared::DrawVolume volume{};
  volume.plane_count = 4;
  for (int i = 0; i < 4; ++i)
    volume.planes[i] = glm::vec4(frustum.sides[i], -glm::dot(frustum.sides[i], camera.position));
  volume.eye = camera.position;
  volume.error = pixels > 0.0f ? 0.0f : -1.0f;
  volume.error_per_metre = pixels > 0.0f ? pixels * 2.0f * frame.tangent / static_cast<float>(height) : -1.0f;
  return volume;
}

}  // namespace helio::render
