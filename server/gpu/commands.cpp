#include "gpu/commands.h"

#include <algorithm>
#include <utility>

#include "gpu/pipelines.h"

namespace helio::gpu {
namespace {
constexpr uint64_t kChunkBytes = 4u << 20;

}  // namespace

bool writes(const Use& use) {
  constexpr VkAccessFlags2 kWrites = VK_ACCESS_2_SHADER_WRITE_BIT | VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT |
                                     VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT | VK_ACCESS_2_TRANSFER_WRITE_BIT |
                                     VK_ACCESS_2_ACCELERATION_STRUCTURE_WRITE_BIT_KHR | VK_ACCESS_2_MEMORY_WRITE_BIT;
  return (use.access & kWrites) != 0;
}

Commands::Commands(Device& device, Queue queue) : device_(device), queue_(queue) {
  VkCommandPoolCreateInfo pool{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
  pool.queueFamilyIndex = device.queueFamily(queue);
  check(vkCreateCommandPool(device.handle(), &pool, nullptr, &pool_), "a command pool");
}

Commands::~Commands() {
  if (submitted_.value > 0) device_.wait(submitted_);
  vkDestroyQueryPool(device_.handle(), queries_, nullptr);
  vkDestroyCommandPool(device_.handle(), pool_, nullptr);
}

void Commands::begin() {
  if (submitted_.value > 0) (void)finish();
  check(vkResetCommandPool(device_.handle(), pool_, 0), "resetting a command pool");
  opened_ = 0;
  after_ = {};
  timers_.clear();
  timestamps_ = 0;
  for (Chunk& chunk : chunks_) chunk.used = 0;
  retired_.clear();
  open();
}

void Commands::open() {
  if (opened_ == buffers_.size()) {
    VkCommandBufferAllocateInfo allocate{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO};
    allocate.commandPool = pool_;
    allocate.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
    allocate.commandBufferCount = 1;
    check(vkAllocateCommandBuffers(device_.handle(), &allocate, &buffers_.emplace_back()), "a command buffer");
  }
  handle_ = buffers_[opened_++];
  VkCommandBufferBeginInfo info{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
  info.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
  check(vkBeginCommandBuffer(handle_, &info), "recording a frame");
  const VkDescriptorSet set = device_.bindless().set();
  for (VkPipelineBindPoint point :
       {VK_PIPELINE_BIND_POINT_COMPUTE, VK_PIPELINE_BIND_POINT_GRAPHICS, VK_PIPELINE_BIND_POINT_RAY_TRACING_KHR})
    if (queue_ == Queue::main || point != VK_PIPELINE_BIND_POINT_GRAPHICS)
      vkCmdBindDescriptorSets(handle_, point, device_.pipelineLayout(), 0, 1, &set, 0, nullptr);
}

Point Commands::submit() {
  check(vkEndCommandBuffer(handle_), "recording a frame");
  submitted_ = device_.submit(queue_, handle_, std::exchange(after_, {}));
  return submitted_;
}

Point Commands::cut() {
  const Point point = submit();
  open();
  return point;
}

std::vector<TimedPass> Commands::finish() {
  device_.wait(submitted_);
  submitted_ = {};
  retired_.clear();
  std::vector<uint64_t> ticks(timestamps_);
  if (timestamps_)
    check(vkGetQueryPoolResults(device_.handle(), queries_, 0, timestamps_, ticks.size() * sizeof(uint64_t),
                                ticks.data(), sizeof(uint64_t), VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT),
          "reading timestamps");
  const auto ms = [this](uint64_t from, uint64_t to) {
    return static_cast<double>(to - from) * device_.timestampPeriodNs() * 1e-6;
  };
  std::vector<TimedPass> passes;
  for (size_t i = 0; i < timers_.size(); ++i) passes.push_back({timers_[i], ms(ticks[2 * i], ticks[2 * i + 1])});
  span_ms_ = ticks.empty() ? 0.0 : ms(ticks.front(), ticks.back());
  return passes;
}

Staging Commands::stage(uint64_t bytes, uint64_t alignment) {
  for (Chunk& chunk : chunks_) {
    const uint64_t offset = alignUp(chunk.used, alignment);
    if (offset + bytes > chunk.buffer.size()) continue;
    chunk.used = offset + bytes;
    return {chunk.buffer.mapped() + offset, chunk.buffer.handle(), offset};
  }
  BufferDescription description{"the upload ring", std::max(kChunkBytes, bytes), MemoryCategory::transfer,
                                Placement::upload};
  Buffer buffer(device_, description);
  if (bytes > kChunkBytes) {  // one-off: not worth keeping
    const Staging staging{buffer.mapped(), buffer.handle(), 0};
    retire(std::move(buffer));
    return staging;
  }
  chunks_.push_back({std::move(buffer), 0});
  return stage(bytes, alignment);
}

void Commands::upload(const Buffer& to, uint64_t offset, std::span<const std::byte> bytes) {
  if (bytes.empty()) return;
  const Staging staging = stage(bytes.size());
  std::memcpy(staging.mapped, bytes.data(), bytes.size());
  const VkBufferCopy region{staging.offset, offset, bytes.size()};
  vkCmdCopyBuffer(handle_, staging.buffer, to.handle(), 1, &region);
}

void Commands::copy(const Buffer& from, const Buffer& to, uint64_t bytes, uint64_t from_offset, uint64_t to_offset) {
  const VkBufferCopy region{from_offset, to_offset, bytes};
  vkCmdCopyBuffer(handle_, from.handle(), to.handle(), 1, &region);
}

void Commands::copy(const Image& from, const Buffer& to) {
  VkBufferImageCopy region{};
  region.imageSubresource = {from.aspect(), 0, 0, 1};
  region.imageExtent = {from.width(), from.height(), 1};
  vkCmdCopyImageToBuffer(handle_, from.handle(), VK_IMAGE_LAYOUT_GENERAL, to.handle(), 1, &region);
}

void Commands::fill(const Buffer& buffer, uint32_t value) {
  vkCmdFillBuffer(handle_, buffer.handle(), 0, VK_WHOLE_SIZE, value);
}

void Commands::uploadTexture(const Image& image, std::span<const std::byte> texels) {
  prepare(image);
  const Staging staging = stage(texels.size());
  std::memcpy(staging.mapped, texels.data(), texels.size());
  VkBufferImageCopy region{};
  region.bufferOffset = staging.offset;
  region.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
  region.imageExtent = {image.width(), image.height(), 1};
  vkCmdCopyBufferToImage(handle_, staging.buffer, image.handle(), VK_IMAGE_LAYOUT_GENERAL, 1, &region);

  const auto edge = [](uint32_t size, uint32_t mip) { return static_cast<int32_t>(std::max(1u, size >> mip)); };
  for (uint32_t mip = 1; mip < image.mips(); ++mip) {
    barrier(use::transfer_write,
            {VK_PIPELINE_STAGE_2_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_READ_BIT | VK_ACCESS_2_TRANSFER_WRITE_BIT});
    VkImageBlit blit{};
    blit.srcSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, mip - 1, 0, 1};
    blit.srcOffsets[1] = {edge(image.width(), mip - 1), edge(image.height(), mip - 1), 1};
    blit.dstSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, mip, 0, 1};
    blit.dstOffsets[1] = {edge(image.width(), mip), edge(image.height(), mip), 1};
    vkCmdBlitImage(handle_, image.handle(), VK_IMAGE_LAYOUT_GENERAL, image.handle(), VK_IMAGE_LAYOUT_GENERAL, 1, &blit,
                   VK_FILTER_LINEAR);
  }
}

void Commands::bind(const ComputePipeline& pipeline) {
  vkCmdBindPipeline(handle_, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline.handle());
}
void Commands::bind(const RasterPipeline& pipeline) {
  vkCmdBindPipeline(handle_, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline.handle());
}
void Commands::bind(const RayTracingPipeline& pipeline) {
  vkCmdBindPipeline(handle_, VK_PIPELINE_BIND_POINT_RAY_TRACING_KHR, pipeline.handle());
}

void Commands::traceRays(const RayTracingPipeline& pipeline, uint32_t width, uint32_t height) {
  const VkStridedDeviceAddressRegionKHR callable{};
  vkCmdTraceRaysKHR(handle_, &pipeline.raygen(), &pipeline.miss(), &pipeline.hit(), &callable, width, height, 1);
}

void Commands::traceRaysIndirect(const RayTracingPipeline& pipeline, const Buffer& sizes, uint64_t offset) {
  const VkStridedDeviceAddressRegionKHR callable{};
  vkCmdTraceRaysIndirectKHR(handle_, &pipeline.raygen(), &pipeline.miss(), &pipeline.hit(), &callable,
                            sizes.address() + offset);
}

void Commands::barrier(std::span<const Dependency> dependencies) {
  if (dependencies.empty()) return;
  std::vector<VkMemoryBarrier2> barriers;
  for (const auto& [before, after] : dependencies)
    barriers.push_back(
        {VK_STRUCTURE_TYPE_MEMORY_BARRIER_2, nullptr, before.stages, before.access, after.stages, after.access});
  VkDependencyInfo dependency{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
  dependency.memoryBarrierCount = static_cast<uint32_t>(barriers.size());
  dependency.pMemoryBarriers = barriers.data();
  vkCmdPipelineBarrier2(handle_, &dependency);
}

void Commands::prepare(const Image& image) {
  VkImageMemoryBarrier2 transition{VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2};
  transition.srcStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
  transition.dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
  transition.dstAccessMask = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT;
  transition.newLayout = VK_IMAGE_LAYOUT_GENERAL;
  transition.srcQueueFamilyIndex = transition.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  transition.image = image.handle();
  transition.subresourceRange = {image.aspect(), 0, image.mips(), 0, 1};
  VkDependencyInfo dependency{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
  dependency.imageMemoryBarrierCount = 1;
  dependency.pImageMemoryBarriers = &transition;
  vkCmdPipelineBarrier2(handle_, &dependency);
}

void Commands::reserveTimers(size_t passes) {
  const auto wanted = static_cast<uint32_t>(2 * passes);
  if (wanted > timestamp_capacity_) {
    vkDestroyQueryPool(device_.handle(), queries_, nullptr);
    queries_ = VK_NULL_HANDLE;
    timestamp_capacity_ = 0;
    VkQueryPoolCreateInfo info{VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO};
    info.queryType = VK_QUERY_TYPE_TIMESTAMP;
    info.queryCount = wanted;
    check(vkCreateQueryPool(device_.handle(), &info, nullptr, &queries_), "a pool of timestamps");
    timestamp_capacity_ = wanted;
  }
  if (wanted) vkResetQueryPool(device_.handle(), queries_, 0, wanted);
}

void Commands::beginTimer(const std::string& name) {
  timers_.push_back(name);
  writeTimestamp();
}

void Commands::endTimer() { writeTimestamp(); }

void Commands::writeTimestamp() {
  vkCmdWriteTimestamp2(handle_, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, queries_, timestamps_++);
  // lavapipe flushes raster work lazily: without a full barrier after every timestamp a pass is billed to its
  // neighbour.
  if (device_.cpu()) barrier(use::everything, use::everything);
}

}  // namespace helio::gpu
