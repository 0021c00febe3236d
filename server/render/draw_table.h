// What there is to rasterise in a world: its instances by mesh. Touched by edits alone, not by what moves.
#pragma once

#include "accel/instance_table.h"
#include "gpu/commands.h"

namespace helio::render {

class DrawTable {
 public:
  DrawTable(gpu::Device& device, size_t mesh_count) : device_(device), mesh_first_(mesh_count + 1) {}

  /// The instances are others than before.
  void invalidate() { dirty_ = true; }
  bool dirty() const { return dirty_ || !slots_buffer_; }
  /// Orders slots by mesh, and records their copies (transfer writes).
  void upload(gpu::Commands& commands, const accel::InstanceTable& table);

  /// Nobody rasterises: gives the memory back.
  void release(gpu::Commands& commands);

  uint32_t count() const { return static_cast<uint32_t>(by_mesh_.size()); }
  uint32_t meshes() const { return static_cast<uint32_t>(mesh_first_.size() - 1); }
  uint64_t cpuBytes() const { return (by_mesh_.capacity() + mesh_first_.capacity()) * sizeof(uint32_t); }
  VkDeviceAddress byMesh() const { return slots_buffer_.address(); }
  VkDeviceAddress meshFirst() const { return first_buffer_.address(); }

 private:
  gpu::Device& device_;
  std::vector<uint32_t> by_mesh_;     // slots, ascending by mesh, then by slot
  std::vector<uint32_t> mesh_first_;  // by mesh; and one more
  gpu::Buffer slots_buffer_, first_buffer_;
  bool dirty_ = true;
};

}  // namespace helio::render
