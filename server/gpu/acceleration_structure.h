// Acceleration structures as Vulkan sees them: sizes, memory, batched builds. What to build is accel/'s business.
#pragma once

#include <span>
#include <vector>

#include "gpu/commands.h"
#include "gpu/memory.h"
#include "gpu/range_pool.h"

namespace helio::gpu {

/// Owns a structure, and its memory unless that is a range of a pool. Move-only.
class AccelerationStructure {
 public:
  AccelerationStructure() = default;
  AccelerationStructure(Device& device, const std::string& name, VkAccelerationStructureTypeKHR type, uint64_t size);
  /// In a range of a pool whose buffers have acceleration structure storage, aligned to 256; the range must outlive it.
  AccelerationStructure(Device& device, const std::string& name, VkAccelerationStructureTypeKHR type,
                        const Range& range);
  AccelerationStructure(AccelerationStructure&& other) noexcept { swap(other); }
  AccelerationStructure& operator=(AccelerationStructure&& other) noexcept {
    AccelerationStructure(std::move(other)).swap(*this);
    return *this;
  }
  ~AccelerationStructure();

  explicit operator bool() const { return handle_ != VK_NULL_HANDLE; }
  VkAccelerationStructureKHR handle() const { return handle_; }
  VkDeviceAddress address() const { return address_; }            ///< what instances and shaders refer to
  uint64_t size() const { return buffer_ ? buffer_.size() : 0; }  ///< bytes of its own

 private:
  void swap(AccelerationStructure& other) noexcept;
  void create(const std::string& name, VkAccelerationStructureTypeKHR type, VkBuffer buffer, uint64_t offset,
              uint64_t size);
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

/// Builds all of `inputs` in one call (on an H200 a barrier between builds costs 60 times as much), to stand still. The
/// caller places a barrier from build_write before the structures are used.
std::vector<AccelerationStructure> buildBlases(Commands& commands, std::span<const BlasInput> inputs);

/// What a BLAS is built for. `still`: fast to trace, and compact() may shrink it. `moving`: fast to build, and refitted
/// while its vertices move.
enum class BlasKind { still, moving };

/// Bytes that a BLAS needs.
struct BlasSizes {
  uint64_t structure = 0;
  uint64_t build_scratch = 0;
  uint64_t refit_scratch = 0;
};
BlasSizes blasSizes(Device& device, std::span<const BlasGeometry> geometries, BlasKind kind);

/// A BLAS that is built anew, or refitted to where its vertices are now (it was built of the same triangles).
struct BlasUpdate {
  VkAccelerationStructureKHR structure = VK_NULL_HANDLE;
  std::vector<BlasGeometry> geometries;
  BlasKind kind = BlasKind::moving;
  bool refit = false;
};

/// Builds and refits all of `updates` in one call, with scratch memory that the caller keeps: its size is the sum of
/// theirs, each rounded up to the device's scratch alignment. `one_call` false: a call each, with a barrier behind it,
/// to measure what the batch saves.
void updateBlases(Commands& commands, std::span<const BlasUpdate> updates, std::span<const uint64_t> scratch_sizes,
                  const Buffer& scratch, bool one_call = true);
/// The scratch memory that updateBlases() needs for builds of these sizes.
uint64_t scratchFor(Device& device, std::span<const uint64_t> scratch_sizes);

/// The top level, rebuilt each time from an array of VkAccelerationStructureInstanceKHR on the GPU.
class Tlas {
 public:
  VkDeviceAddress address() const { return structure_.address(); }
  uint64_t bytes() const { return structure_.size(); }
  uint64_t scratchBytes() const { return scratch_ ? scratch_.size() : 0; }

 private:
  friend void buildTlases(Commands& commands, std::span<const struct TlasInput> inputs);

  AccelerationStructure structure_;
  Buffer scratch_;
  uint32_t capacity_ = 0;
};

struct TlasInput {
  Tlas* tlas;
  VkDeviceAddress instances;  ///< VkAccelerationStructureInstanceKHR
  uint32_t count;
};
/// Makes storage and scratch fit the instances if need be (no submitted work uses them), then records all builds in one
/// call, so that they run beside each other.
void buildTlases(Commands& commands, std::span<const TlasInput> inputs);

}  // namespace helio::gpu
