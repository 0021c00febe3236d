// The Vulkan device: choice, queues, memory accounts, the bindless set. One owner of the queues for the whole process.
#pragma once

#include <array>
#include <atomic>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "base/result.h"
#include "gpu/memory.h"
#include "gpu/vulkan.h"

namespace helio::gpu {

struct DeviceOptions {
  std::string select;       ///< "cpu", "gpu", part of a name, or "" (HELIOGRAPH_DEVICE, then the best with ray tracing)
  bool validation = false;  ///< Khronos validation layer with synchronisation checks, errors are logged and counted;
                            ///< missing layer = error
};

/// Two tables of images that every shader sees as set 0 (shaders/lib/bindless.glsl). Slots are handed out and
/// returned by Image; entries that no shader touches may be unset.
class Bindless {
 public:
  static constexpr uint32_t kTextures = 16'384;      ///< binding 0: combined image samplers, trilinear
  static constexpr uint32_t kStorageImages = 1'024;  ///< binding 1: storage images

  void create(VkDevice device, float max_anisotropy);
  void destroy(VkDevice device);
  uint32_t add(VkDevice device, VkImageView view, bool storage, const TextureSampling& sampling);
  void remove(uint32_t slot, bool storage);

  VkDescriptorSetLayout layout() const { return layout_; }
  VkDescriptorSet set() const { return set_; }

 private:
  struct Slots {
    uint32_t capacity = 0;
    uint32_t next = 0;
    std::vector<uint32_t> free;
  };
  VkDescriptorSetLayout layout_ = VK_NULL_HANDLE;
  VkDescriptorPool pool_ = VK_NULL_HANDLE;
  VkDescriptorSet set_ = VK_NULL_HANDLE;
  std::vector<VkSampler> samplers_;  // by index()
  std::mutex mutex_;
  std::array<Slots, 2> slots_{{{kTextures, 0, {}}, {kStorageImages, 0, {}}}};
};

/// Where work goes: `async` takes compute work and builds that may run beside what `main` does. A device without a
/// queue for it runs both on one.
enum class Queue : uint8_t { main, async };
inline constexpr size_t kQueues = 2;

/// Reached when all that a queue was given up to a moment is done. Value 0 is reached from the beginning.
struct Point {
  Queue queue = Queue::main;
  uint64_t value = 0;
};

class Device {
 public:
  /// Errors: no Vulkan loader, no device of that name (the ones there are listed), no ray tracing pipelines (says how
  /// to get them), validation layer missing.
  static Result<std::unique_ptr<Device>> create(const DeviceOptions& options);
  ~Device();
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  const std::string& name() const { return name_; }
  const std::string& driver() const { return driver_; }
  bool cpu() const { return cpu_; }  ///< a software device

  VkDevice handle() const { return device_; }
  VmaAllocator allocator() const { return allocator_; }
  Bindless& bindless() { return bindless_; }
  VkPipelineLayout pipelineLayout() const { return pipeline_layout_; }  ///< one for all: set 0 and push constants
  uint32_t queueFamily(Queue queue = Queue::main) const { return lane(queue).family; }
  double timestampPeriodNs() const { return timestamp_period_; }
  const VkPhysicalDeviceRayTracingPipelinePropertiesKHR& rayTracing() const { return ray_tracing_; }
  uint32_t scratchAlignment() const { return scratch_alignment_; }
  uint64_t maxBufferSize() const { return max_buffer_size_; }

  /// Submits what is to run after `after`, and returns what is reached when it is done.
  Point submit(Queue queue, VkCommandBuffer commands, const Point& after = {});
  /// Waits on the CPU. Throws DeviceLost.
  void wait(const Point& point);

  /// Bytes allocated now, by category.
  uint64_t memoryInUse(MemoryCategory category) const { return memory_[static_cast<size_t>(category)].load(); }
  void account(MemoryCategory category, int64_t bytes) {
    memory_[static_cast<size_t>(category)] += static_cast<uint64_t>(bytes);
  }

  /// Validation messages of severity error so far (0 without the layer). Tests assert that it stays 0.
  uint64_t validationErrors() const { return validation_errors_.load(); }

  static constexpr uint32_t kPushConstantBytes = 128;

 private:
  Device() = default;
  Result<void> createInstance();
  Result<void> choosePhysicalDevice();
  void createDevice();
  void chooseQueues();
  static VKAPI_ATTR VkBool32 VKAPI_CALL onMessage(VkDebugUtilsMessageSeverityFlagBitsEXT severity,
                                                  VkDebugUtilsMessageTypeFlagsEXT types,
                                                  const VkDebugUtilsMessengerCallbackDataEXT* data, void* self);

  DeviceOptions options_;
  VkInstance instance_ = VK_NULL_HANDLE;
  VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
  VkPhysicalDevice physical_ = VK_NULL_HANDLE;
  VkDevice device_ = VK_NULL_HANDLE;
  VmaAllocator allocator_ = nullptr;
  /// A queue as its users know it; two of them may share a handle.
  struct Lane {
    VkQueue handle = VK_NULL_HANDLE;
    uint32_t family = 0;
    VkSemaphore timeline = VK_NULL_HANDLE;
    uint64_t value = 0;  // of the timeline when all is done
  };
  Lane& lane(Queue queue) { return lanes_[static_cast<size_t>(queue)]; }
  const Lane& lane(Queue queue) const { return lanes_[static_cast<size_t>(queue)]; }
  std::array<Lane, kQueues> lanes_;
  std::mutex queue_mutex_;
  Bindless bindless_;
  VkPipelineLayout pipeline_layout_ = VK_NULL_HANDLE;
  VkPhysicalDeviceRayTracingPipelinePropertiesKHR ray_tracing_{};
  uint32_t scratch_alignment_ = 256;
  uint64_t max_buffer_size_ = 0;
  double timestamp_period_ = 1.0;
  std::string name_;
  std::string driver_;
  bool cpu_ = false;
  std::array<std::atomic<uint64_t>, kMemoryCategories> memory_{};
  std::atomic<uint64_t> validation_errors_{0};
};

}  // namespace helio::gpu
