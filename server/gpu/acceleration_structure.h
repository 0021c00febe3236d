// Acceleration structures as Vulkan sees them: sizes, memory, batched builds. What to build is accel/'s business.
#pragma once

#include <span>
#include <vector>

#include "gpu/commands.h"
#include "gpu/memory.h"

namespace helio::gpu {

/// Owns a structure and its memory. Move-only.
class AccelerationStructure {
 public:
  AccelerationStructure() = default;
  AccelerationStructure(Device& device, const std::string& name, VkAccelerationStructureTypeKHR type, uint64_t size);
  AccelerationStructure(AccelerationStructure&& other) noexcept { swap(other); }
  AccelerationStructure& operator=(AccelerationStructure&& other) noexcept {
    AccelerationStructure(std::move(other)).swap(*this);
    return *this;
  }
  ~AccelerationStructure();

  explicit operator bool() const { return handle_ != VK_NULL_HANDLE; }
  VkAccelerationStructureKHR handle() const { return handle_; }
  VkDeviceAddress address() const { return address_; }  ///< what instances and shaders refer to

 private:
  void swap(AccelerationStructure& other) noexcept;
  Device* device_ = nullptr;
  Buffer buffer_;
  VkAccelerationStructureKHR handle_ = VK_NULL_HANDLE;
  VkDeviceAddress address_ = 0;
};

/// Triangles of one material: addresses already point at the first vertex and index, because a build with
/// `firstVertex` != 0 comes out wrong on lavapipe.
struct BlasGeometry {
  VkDeviceAddress positions = 0;  ///< float3, 12 bytes apart
  uint32_t vertex_count = 0;
  VkDeviceAddress indices = 0;  ///< uint32, three a triangle
  uint32_t triangle_count = 0;
  bool opaque = true;  ///< false: rays ask the any-hit shader
};

struct BlasInput {
  std::string name;
  std::vector<BlasGeometry> geometries;
};

/// Builds all of `inputs` in one call (on an H200 a barrier between builds costs 60 times as much). Fast to trace. The
/// caller places a barrier from build_write before the structures are used.
std::vector<AccelerationStructure> buildBlases(Commands& commands, std::span<const BlasInput> inputs);

/// The top level, rebuilt each time from an array of VkAccelerationStructureInstanceKHR on the GPU.
class Tlas {
 public:
  /// Grows storage and scratch to `count` instances if need be, then records the build.
  void build(Commands& commands, VkDeviceAddress instances, uint32_t count);
  VkDeviceAddress address() const { return structure_.address(); }

 private:
  AccelerationStructure structure_;
  Buffer scratch_;
  uint32_t capacity_ = 0;
};

}  // namespace helio::gpu
