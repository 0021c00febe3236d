#include "gpu/range_pool.h"

#include <algorithm>

#include "gpu/device.h"

namespace helio::gpu {

RangePool::~RangePool() {
  for (Chunk& chunk : chunks_) {
    if (chunk.block == VK_NULL_HANDLE) continue;
    vmaClearVirtualBlock(chunk.block);
    vmaDestroyVirtualBlock(chunk.block);
  }
}

bool RangePool::allocateFrom(uint32_t index, uint64_t size, uint64_t alignment, Range& range) {
  Chunk& chunk = chunks_[index];
  if (chunk.block == VK_NULL_HANDLE) return false;
  VmaVirtualAllocationCreateInfo info{};
  info.size = size;
  info.alignment = alignment;
  VkDeviceSize offset = 0;
  VmaVirtualAllocation allocation = VK_NULL_HANDLE;
  if (vmaVirtualAllocate(chunk.block, &info, &allocation, &offset) != VK_SUCCESS) return false;
  ++chunk.ranges;
  used_ += size;
  range = {chunk.buffer.handle(), offset, size, chunk.buffer.address() + offset, index, allocation};
  return true;
}

/// Doubles with what is held, so that at most about a quarter of a pool is its last chunk.
uint64_t RangePool::nextChunkBytes() const {
  uint64_t bytes = description_.size / 16;
  while (bytes < description_.size && 8 * bytes < bytesHeld()) bytes *= 2;
  return bytes;
}

Range RangePool::allocate(uint64_t size, uint64_t alignment) {
  Range range;
  for (uint32_t i = 0; i < chunks_.size(); ++i)
    if (allocateFrom(i, size, alignment, range)) return range;

  Chunk chunk;
  BufferDescription description = description_;
  description.size = std::max(nextChunkBytes(), size);
  chunk.buffer = Buffer(device_, description);
  VmaVirtualBlockCreateInfo info{};
  info.size = description.size;
  check(vmaCreateVirtualBlock(&info, &chunk.block), "ranges for " + description_.name);
  const auto empty =
      std::find_if(chunks_.begin(), chunks_.end(), [](const Chunk& c) { return c.block == VK_NULL_HANDLE; });
  const auto index = static_cast<uint32_t>(empty - chunks_.begin());
  if (empty == chunks_.end()) chunks_.push_back(std::move(chunk));
  else *empty = std::move(chunk);
  allocateFrom(index, size, alignment, range);
  return range;
}

void RangePool::free(Range& range) {
  if (!range) return;
  Chunk& chunk = chunks_[range.chunk];
  vmaVirtualFree(chunk.block, range.allocation);
  used_ -= range.size;
  range = {};
  if (--chunk.ranges > 0) return;
  vmaDestroyVirtualBlock(chunk.block);
  chunk = {};
}

bool RangePool::moveForward(Range& range, uint64_t alignment) {
  if (bytesHeld() - used_ < range.size) return false;
  Range earlier;
  for (uint32_t i = 0; i < range.chunk && !earlier; ++i) (void)allocateFrom(i, range.size, alignment, earlier);
  if (!earlier) return false;
  free(range);
  range = earlier;
  return true;
}

uint64_t RangePool::bytesHeld() const {
  uint64_t bytes = 0;
  for (const Chunk& chunk : chunks_)
    if (chunk.block != VK_NULL_HANDLE) bytes += chunk.buffer.size();
  return bytes;
}

}  // namespace helio::gpu
