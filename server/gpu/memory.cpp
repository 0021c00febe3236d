#include "gpu/memory.h"

#include <algorithm>

#include "gpu/device.h"

namespace helio::gpu {

// Both constructors delegate, so that the destructor tidies up when they throw half way.
Buffer::Buffer(Device& device, const BufferDescription& description) : Buffer() {
  device_ = &device;
  size_ = std::max<uint64_t>(description.size, 16);
  category_ = description.category;
  const std::string asked_for = "a buffer of " + bytesInWords(size_) + " for " + description.name;
  if (size_ > device.maxBufferSize())
    throw Failure({ErrorKind::limit,
                   asked_for + " is more than this device allows: " + bytesInWords(device.maxBufferSize()),
                   {},
                   {},
                   std::to_string(device.maxBufferSize())});
  VkBufferCreateInfo info{VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO};
  info.size = size_;
  info.usage = description.usage | VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT |
               VK_BUFFER_USAGE_TRANSFER_DST_BIT | VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT;
  // Both queues may use any buffer; who goes first is said by points.
  const std::array<uint32_t, kQueues> families = {device.queueFamily(Queue::main), device.queueFamily(Queue::async)};
  if (families[0] != families[1]) {
    info.sharingMode = VK_SHARING_MODE_CONCURRENT;
    info.queueFamilyIndexCount = static_cast<uint32_t>(families.size());
    info.pQueueFamilyIndices = families.data();
  }
  VmaAllocationCreateInfo placement{};
  placement.usage = VMA_MEMORY_USAGE_AUTO_PREFER_DEVICE;
  if (description.placement != Placement::device) {
    placement.usage = VMA_MEMORY_USAGE_AUTO_PREFER_HOST;
    // Uploads are written without a flush; what is read back is invalidated first.
    if (description.placement == Placement::upload) placement.requiredFlags = VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    placement.flags = VMA_ALLOCATION_CREATE_MAPPED_BIT | (description.placement == Placement::upload
                                                              ? VMA_ALLOCATION_CREATE_HOST_ACCESS_SEQUENTIAL_WRITE_BIT
                                                              : VMA_ALLOCATION_CREATE_HOST_ACCESS_RANDOM_BIT);
  }
  VmaAllocationInfo allocated{};
  // The alignment serves shader tables, scratch and acceleration structures, whatever the device asks for.
  check(vmaCreateBufferWithAlignment(device.allocator(), &info, &placement, 256, &handle_, &allocation_, &allocated),
        asked_for);
  vmaSetAllocationName(device.allocator(), allocation_, description.name.c_str());
  mapped_ = static_cast<std::byte*>(allocated.pMappedData);
  VkBufferDeviceAddressInfo address{VK_STRUCTURE_TYPE_BUFFER_DEVICE_ADDRESS_INFO};
  address.buffer = handle_;
  address_ = vkGetBufferDeviceAddress(device.handle(), &address);
  device.account(category_, static_cast<int64_t>(size_));
}

Buffer::~Buffer() {
  if (!handle_) return;
  vmaDestroyBuffer(device_->allocator(), handle_, allocation_);
  device_->account(category_, -static_cast<int64_t>(size_));
}

void Buffer::invalidate() const {
  check(vmaInvalidateAllocation(device_->allocator(), allocation_, 0, VK_WHOLE_SIZE), "reading a buffer back");
}

void Buffer::swap(Buffer& other) noexcept {
  std::swap(device_, other.device_);
  std::swap(handle_, other.handle_);
  std::swap(allocation_, other.allocation_);
  std::swap(address_, other.address_);
  std::swap(size_, other.size_);
  std::swap(mapped_, other.mapped_);
  std::swap(category_, other.category_);
}

Image::Image(Device& device, const ImageDescription& description) : Image() {
  device_ = &device;
  description_ = description;
  VkImageCreateInfo info{VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO};
  info.imageType = VK_IMAGE_TYPE_2D;
  info.format = description.format;
  info.extent = {description.width, description.height, 1};
  info.mipLevels = description.mips;
  info.arrayLayers = 1;
  info.samples = VK_SAMPLE_COUNT_1_BIT;
  info.tiling = VK_IMAGE_TILING_OPTIMAL;
  info.usage = description.usage;
  VmaAllocationCreateInfo placement{};
  placement.usage = VMA_MEMORY_USAGE_AUTO_PREFER_DEVICE;
  const std::string asked_for = "an image of " + std::to_string(description.width) + " x " +
                                std::to_string(description.height) + " for " + description.name;
  VmaAllocationInfo allocated{};
  check(vmaCreateImage(device.allocator(), &info, &placement, &handle_, &allocation_, &allocated), asked_for);
  vmaSetAllocationName(device.allocator(), allocation_, description.name.c_str());
  size_ = allocated.size;
  device.account(description.category, static_cast<int64_t>(size_));

  VkImageViewCreateInfo view{VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO};
  view.image = handle_;
  view.viewType = VK_IMAGE_VIEW_TYPE_2D;
  view.format = description.format;
  view.subresourceRange = {aspect(), 0, description.mips, 0, 1};
  check(vkCreateImageView(device.handle(), &view, nullptr, &view_), asked_for);
  if (description.usage & (VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_SAMPLED_BIT))
    slot_ = device.bindless().add(device.handle(), view_, (description.usage & VK_IMAGE_USAGE_STORAGE_BIT) != 0,
                                  description.sampling);
}

Image::~Image() {
  if (!handle_) return;
  if (slot_ != kNoSlot) device_->bindless().remove(slot_, (description_.usage & VK_IMAGE_USAGE_STORAGE_BIT) != 0);
  vkDestroyImageView(device_->handle(), view_, nullptr);
  vmaDestroyImage(device_->allocator(), handle_, allocation_);
  device_->account(description_.category, -static_cast<int64_t>(size_));
}

VkImageAspectFlags Image::aspect() const {
  return description_.format == VK_FORMAT_D32_SFLOAT ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT;
}

void Image::swap(Image& other) noexcept {
  std::swap(device_, other.device_);
  std::swap(description_, other.description_);
  std::swap(handle_, other.handle_);
  std::swap(view_, other.view_);
  std::swap(allocation_, other.allocation_);
  std::swap(size_, other.size_);
  std::swap(slot_, other.slot_);
}

}  // namespace helio::gpu
