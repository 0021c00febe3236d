// Pipelines from the embedded SPIR-V. Every pipeline has the same layout: set 0 bindless, 128 bytes of push constants.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "gpu/device.h"
#include "gpu/memory.h"

namespace helio::gpu {

/// Values of specialisation constants 0, 1, 2, ... (booleans as 0 or 1).
using Specialisation = std::vector<uint32_t>;

/// Owns a VkPipeline. Move-only.
class Pipeline {
 public:
  Pipeline() = default;
  Pipeline(Pipeline&& other) noexcept { swap(other); }
  Pipeline& operator=(Pipeline&& other) noexcept {
    Pipeline(std::move(other)).swap(*this);
    return *this;
  }
  ~Pipeline();
  VkPipeline handle() const { return handle_; }
  explicit operator bool() const { return handle_ != VK_NULL_HANDLE; }

 protected:
  void swap(Pipeline& other) noexcept {
    std::swap(device_, other.device_);
    std::swap(handle_, other.handle_);
  }
  Device* device_ = nullptr;
  VkPipeline handle_ = VK_NULL_HANDLE;
};

/// `shader`: its path below shaders/, "tonemap/tonemap.comp".
class ComputePipeline : public Pipeline {
 public:
  ComputePipeline() = default;
  ComputePipeline(Device& device, const std::string& shader, const Specialisation& constants = {});
  /// From the words of a module that is not below shaders/; `name` is for messages.
  ComputePipeline(Device& device, const std::string& name, std::span<const uint32_t> words,
                  const Specialisation& constants = {});
};

struct RasterDescription {
  std::string vertex;
  std::string fragment;
  std::vector<VkFormat> colors;
  VkFormat depth = VK_FORMAT_D32_SFLOAT;
  Specialisation constants;
};

/// Triangles without vertex buffers (shaders pull by address), reversed depth (greater is nearer), both faces drawn;
/// dynamic viewport and scissor.
class RasterPipeline : public Pipeline {
 public:
  RasterPipeline() = default;
  RasterPipeline(Device& device, const RasterDescription& description);
};

struct HitGroup {
  std::string closest_hit;  ///< may be empty
  std::string any_hit;      ///< may be empty
};

struct RayTracingDescription {
  std::string raygen;
  std::vector<std::string> misses;
  std::vector<HitGroup> hits;
  Specialisation constants;
};

/// A ray tracing pipeline without recursion (traceRayEXT in raygen only) and its shader table.
class RayTracingPipeline : public Pipeline {
 public:
  RayTracingPipeline() = default;
  RayTracingPipeline(Device& device, const RayTracingDescription& description);
  const VkStridedDeviceAddressRegionKHR& raygen() const { return raygen_; }
  const VkStridedDeviceAddressRegionKHR& miss() const { return miss_; }
  const VkStridedDeviceAddressRegionKHR& hit() const { return hit_; }

 private:
  Buffer table_;
  VkStridedDeviceAddressRegionKHR raygen_{};
  VkStridedDeviceAddressRegionKHR miss_{};
  VkStridedDeviceAddressRegionKHR hit_{};
};

}  // namespace helio::gpu
