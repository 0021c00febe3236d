// Many small ranges out of few buffers, by VMA's virtual allocator (TLSF).
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "gpu/memory.h"

namespace helio::gpu {

/// A piece of one of a pool's buffers. Give it back to the pool that it came from.
struct Range {
  VkBuffer buffer = VK_NULL_HANDLE;
  uint64_t offset = 0;          ///< bytes within the buffer
  uint64_t size = 0;            ///< bytes
  VkDeviceAddress address = 0;  ///< of its first byte
  uint32_t chunk = 0;
  VmaVirtualAllocation allocation = VK_NULL_HANDLE;

  explicit operator bool() const { return size != 0; }
};

/// Grows a chunk at a time and gives chunks back that nothing is left in. The caller frees a range only when no
/// submitted work uses it. Not thread-safe.
class RangePool {
 public:
  /// `chunk.size`: bytes of the largest chunk; the first ones are a sixteenth of it, so that a pool of few ranges is
  /// small. A range that is larger gets a chunk of its own.
  RangePool(Device& device, BufferDescription chunk) : device_(device), description_(std::move(chunk)) {}
  ~RangePool();
  RangePool(const RangePool&) = delete;
  RangePool& operator=(const RangePool&) = delete;

  /// `alignment`: a power of two, at most 256. Throws Failure when memory runs out.
  Range allocate(uint64_t size, uint64_t alignment);
  void free(Range& range);
  /// Moves a range, without what it holds, to an earlier chunk where one has room: pools that shrank give chunks back
  /// when their owners call this now and then. False: it stays.
  bool moveForward(Range& range, uint64_t alignment);

  uint64_t bytesHeld() const;  ///< of all chunks
  uint64_t bytesUsed() const { return used_; }

 private:
  struct Chunk {
    Buffer buffer;
    VmaVirtualBlock block = VK_NULL_HANDLE;
    uint64_t ranges = 0;
  };
  uint64_t nextChunkBytes() const;
  bool allocateFrom(uint32_t chunk, uint64_t size, uint64_t alignment, Range& range);

  Device& device_;
  BufferDescription description_;
  std::vector<Chunk> chunks_;  // freed ones stay as empty entries: ranges know theirs by index
  uint64_t used_ = 0;
};

}  // namespace helio::gpu
