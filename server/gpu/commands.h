// One frame's commands for a queue with everything that lives as long as they: upload ring, timestamps, retired
// buffers.
#pragma once

#include <array>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include "gpu/device.h"
#include "gpu/memory.h"

namespace helio::gpu {

class ComputePipeline;
class RasterPipeline;
class RayTracingPipeline;

/// How a pass touches a resource: pipeline stages and accesses, in Vulkan's terms.
struct Use {
  VkPipelineStageFlags2 stages = 0;
  VkAccessFlags2 access = 0;
};

namespace use {
inline constexpr Use compute_read{VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_SHADER_READ_BIT};
inline constexpr Use compute_write{VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT,
                                   VK_ACCESS_2_SHADER_READ_BIT | VK_ACCESS_2_SHADER_WRITE_BIT};
inline constexpr Use ray_read{VK_PIPELINE_STAGE_2_RAY_TRACING_SHADER_BIT_KHR, VK_ACCESS_2_SHADER_READ_BIT};
inline constexpr Use ray_write{VK_PIPELINE_STAGE_2_RAY_TRACING_SHADER_BIT_KHR,
                               VK_ACCESS_2_SHADER_READ_BIT | VK_ACCESS_2_SHADER_WRITE_BIT};
inline constexpr Use trace{VK_PIPELINE_STAGE_2_RAY_TRACING_SHADER_BIT_KHR,
                           VK_ACCESS_2_ACCELERATION_STRUCTURE_READ_BIT_KHR};
inline constexpr Use raster_read{VK_PIPELINE_STAGE_2_VERTEX_SHADER_BIT | VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT,
                                 VK_ACCESS_2_SHADER_READ_BIT};
inline constexpr Use color_write{VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT,
                                 VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT | VK_ACCESS_2_COLOR_ATTACHMENT_READ_BIT};
inline constexpr Use depth_write{
    VK_PIPELINE_STAGE_2_EARLY_FRAGMENT_TESTS_BIT | VK_PIPELINE_STAGE_2_LATE_FRAGMENT_TESTS_BIT,
    VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT | VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_READ_BIT};
/// Building reads vertices, instances and scratch as shader reads, and other structures as such.
inline constexpr Use build_read{VK_PIPELINE_STAGE_2_ACCELERATION_STRUCTURE_BUILD_BIT_KHR,
                                VK_ACCESS_2_SHADER_READ_BIT | VK_ACCESS_2_ACCELERATION_STRUCTURE_READ_BIT_KHR};
inline constexpr Use build_write{
    VK_PIPELINE_STAGE_2_ACCELERATION_STRUCTURE_BUILD_BIT_KHR,
    VK_ACCESS_2_ACCELERATION_STRUCTURE_READ_BIT_KHR | VK_ACCESS_2_ACCELERATION_STRUCTURE_WRITE_BIT_KHR};
inline constexpr Use transfer_read{VK_PIPELINE_STAGE_2_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_READ_BIT};
inline constexpr Use transfer_write{VK_PIPELINE_STAGE_2_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT};
inline constexpr Use host_read{VK_PIPELINE_STAGE_2_HOST_BIT, VK_ACCESS_2_HOST_READ_BIT};
inline constexpr Use everything{VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
                                VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT};
}  // namespace use

/// `after` waits for `before` and sees what it wrote.
struct Dependency {
  Use before, after;
};

/// True when `use` changes memory.
bool writes(const Use& use);

/// A span of upload memory that lives until the frame is done.
struct Staging {
  std::byte* mapped = nullptr;
  VkBuffer buffer = VK_NULL_HANDLE;
  uint64_t offset = 0;
};

struct TimedPass {
  std::string name;
  double ms = 0.0;
};

/// Records one frame at a time: begin() → record → submit() → finish(). Not thread-safe; each world has its own.
class Commands {
 public:
  explicit Commands(Device& device, Queue queue = Queue::main);
  ~Commands();
  Commands(const Commands&) = delete;
  Commands& operator=(const Commands&) = delete;

  Device& device() { return device_; }
  VkCommandBuffer handle() const { return handle_; }

  void begin();
  Point submit();
  /// Submits what was recorded so far, and goes on recording.
  Point cut();
  /// What was recorded since begin() or the last cut(), and all that follows, waits on the GPU for `point`.
  void await(const Point& point) { after_ = point; }
  /// Waits for what was submitted; returns the timed passes in order. Upload memory and retired buffers are free again.
  std::vector<TimedPass> finish();
  /// From the first timed pass's beginning to the last one's end, in ms; after finish().
  double spanMs() const { return span_ms_; }

  // ---- Transfer ----
  Staging stage(uint64_t bytes, uint64_t alignment = 16);
  void upload(const Buffer& to, uint64_t offset, std::span<const std::byte> bytes);
  template <typename T>
  void upload(const Buffer& to, uint64_t first, std::span<const T> items) {
    upload(to, first * sizeof(T), std::as_bytes(items));
  }
  void copy(const Buffer& from, const Buffer& to, uint64_t bytes, uint64_t from_offset = 0, uint64_t to_offset = 0);
  void copy(const Image& from, const Buffer& to);
  void fill(const Buffer& buffer, uint32_t value);
  /// Level 0 from tightly packed texels, the rest by halving.
  void uploadTexture(const Image& image, std::span<const std::byte> texels);
  /// Keeps a buffer that this frame still uses until the frame is done.
  void retire(Buffer&& buffer) { retired_.push_back(std::move(buffer)); }

  // ---- Work ----
  void bind(const ComputePipeline& pipeline);
  void bind(const RasterPipeline& pipeline);
  void bind(const RayTracingPipeline& pipeline);
  template <typename T>
  void push(const T& constants) {
    static_assert(sizeof(T) <= Device::kPushConstantBytes);
    vkCmdPushConstants(handle_, device_.pipelineLayout(), VK_SHADER_STAGE_ALL, 0, sizeof(T), &constants);
  }
  void dispatch(uint32_t groups_x, uint32_t groups_y = 1, uint32_t groups_z = 1) {
    vkCmdDispatch(handle_, groups_x, groups_y, groups_z);
  }
  void traceRays(const RayTracingPipeline& pipeline, uint32_t width, uint32_t height);
  /// Sizes that the GPU wrote: a VkDispatchIndirectCommand, a VkTraceRaysIndirectCommandKHR at `offset`.
  void dispatchIndirect(const Buffer& sizes, uint64_t offset) {
    vkCmdDispatchIndirect(handle_, sizes.handle(), offset);
  }
  void traceRaysIndirect(const RayTracingPipeline& pipeline, const Buffer& sizes, uint64_t offset);

  // ---- Order and time ----
  void barrier(std::span<const Dependency> dependencies);
  void barrier(const Use& before, const Use& after) { barrier(std::array{Dependency{before, after}}); }
  /// UNDEFINED → GENERAL, once after creation. Contents are undefined.
  void prepare(const Image& image);
  /// Makes room for `passes` timers; before the first beginTimer() of a frame.
  void reserveTimers(size_t passes);
  void beginTimer(const std::string& name);
  void endTimer();

 private:
  void open();
  void writeTimestamp();
  struct Chunk {
    Buffer buffer;
    uint64_t used = 0;
  };

  Device& device_;
  Queue queue_;
  VkCommandPool pool_ = VK_NULL_HANDLE;
  std::vector<VkCommandBuffer> buffers_;  // one from cut to cut
  size_t opened_ = 0;
  VkCommandBuffer handle_ = VK_NULL_HANDLE;  // the one that is open
  VkQueryPool queries_ = VK_NULL_HANDLE;
  std::vector<std::string> timers_;
  uint32_t timestamps_ = 0;
  uint32_t timestamp_capacity_ = 0;
  std::vector<Chunk> chunks_;
  std::vector<Buffer> retired_;
  Point after_, submitted_;
  double span_ms_ = 0.0;
};

}  // namespace helio::gpu
