// GPU memory: buffers and images that free themselves, counted by the categories of the thesis (§4.3).
#pragma once

#include <cstdint>
#include <string>
#include <type_traits>
#include <utility>

#include "gpu/vulkan.h"

namespace helio::gpu {

class Device;

/// The next multiple of `alignment` (> 0).
template <typename T>
constexpr T alignUp(T value, std::type_identity_t<T> alignment) {
  return (value + alignment - 1) / alignment * alignment;
}

/// What memory is needed for [Kelling §4.3].
enum class MemoryCategory {
  raster,        ///< by rasterisation too: meshes, textures, materials, common targets
  ray_tracing,   ///< inherent to ray tracing: acceleration structures, scratch, instance buffers
  path_tracing,  ///< path tracing only: accumulation, light tables
  transfer,      ///< staging and read-back; not part of the thesis's account
};
inline constexpr size_t kMemoryCategories = 4;

enum class Placement {
  device,    ///< the GPU's own memory
  upload,    ///< mapped, written by the CPU in order
  readback,  ///< mapped, cached, read by the CPU
};

struct BufferDescription {
  std::string name;
  uint64_t size = 0;  ///< bytes; 0 is rounded up to 16, so that an empty table still has an address
  MemoryCategory category = MemoryCategory::raster;
  Placement placement = Placement::device;
  VkBufferUsageFlags usage = 0;  ///< beyond storage, transfer and device address, which every buffer has
};

/// Move-only. Destroy it only when no submitted work uses it (Commands::retire() keeps it until then).
class Buffer {
 public:
  Buffer() = default;
  Buffer(Device& device, const BufferDescription& description);
  Buffer(Buffer&& other) noexcept { swap(other); }
  Buffer& operator=(Buffer&& other) noexcept {
    Buffer(std::move(other)).swap(*this);
    return *this;
  }
  ~Buffer();

  explicit operator bool() const { return handle_ != VK_NULL_HANDLE; }
  VkBuffer handle() const { return handle_; }
  VkDeviceAddress address() const { return address_; }
  uint64_t size() const { return size_; }
  std::byte* mapped() const { return mapped_; }  ///< upload and readback only
  /// Makes GPU writes visible to the CPU (readback memory need not be coherent).
  void invalidate() const;

 private:
  void swap(Buffer& other) noexcept;

  Device* device_ = nullptr;
  VkBuffer handle_ = VK_NULL_HANDLE;
  VmaAllocation allocation_ = nullptr;
  VkDeviceAddress address_ = 0;
  uint64_t size_ = 0;
  std::byte* mapped_ = nullptr;
  MemoryCategory category_ = MemoryCategory::raster;
};

/// How a texture is magnified, and read beyond its edges. Minified it is always trilinear.
struct TextureSampling {
  bool nearest = false;
  VkSamplerAddressMode u = VK_SAMPLER_ADDRESS_MODE_REPEAT;  ///< REPEAT, MIRRORED_REPEAT or CLAMP_TO_EDGE
  VkSamplerAddressMode v = VK_SAMPLER_ADDRESS_MODE_REPEAT;
};

struct ImageDescription {
  std::string name;
  uint32_t width = 0;
  uint32_t height = 0;
  uint32_t mips = 1;
  VkFormat format = VK_FORMAT_UNDEFINED;
  VkImageUsageFlags usage = 0;
  MemoryCategory category = MemoryCategory::raster;
  TextureSampling sampling{};
};

/// A 2D image, always used in layout GENERAL. With STORAGE or SAMPLED usage it has an index in the bindless set:
/// `slot()` is what shaders are given.
class Image {
 public:
  Image() = default;
  Image(Device& device, const ImageDescription& description);
  Image(Image&& other) noexcept { swap(other); }
  Image& operator=(Image&& other) noexcept {
    Image(std::move(other)).swap(*this);
    return *this;
  }
  ~Image();

  explicit operator bool() const { return handle_ != VK_NULL_HANDLE; }
  VkImage handle() const { return handle_; }
  VkImageView view() const { return view_; }
  uint32_t width() const { return description_.width; }
  uint32_t height() const { return description_.height; }
  uint32_t mips() const { return description_.mips; }
  VkImageAspectFlags aspect() const;
  uint32_t slot() const { return slot_; }

 private:
  void swap(Image& other) noexcept;

  Device* device_ = nullptr;
  ImageDescription description_;
  VkImage handle_ = VK_NULL_HANDLE;
  VkImageView view_ = VK_NULL_HANDLE;
  VmaAllocation allocation_ = nullptr;
  uint64_t size_ = 0;
  static constexpr uint32_t kNoSlot = 0xffffffffu;
  uint32_t slot_ = kNoSlot;
};

}  // namespace helio::gpu
