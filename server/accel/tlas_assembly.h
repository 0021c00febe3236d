// The TLAS of a world: instances written on the GPU in Morton order, then built.
#pragma once

#include "accel/instance_table.h"
#include "gpu/acceleration_structure.h"
#include "gpu/pipelines.h"

namespace helio::accel {

class TlasAssembly {
 public:
  explicit TlasAssembly(gpu::Device& device);

  /// Sizes the instance buffer: the next bucket above 1.25 times the count, so that the build count changes seldom;
  /// what lies behind the last instance is null.
  void reserve(gpu::Commands& commands, uint32_t count);
  /// Compute: writes `capacity()` TLAS instances from the table, in its order.
  void assemble(gpu::Commands& commands, const InstanceTable& table, VkDeviceAddress meshes);
  /// Builds the structure from what was assembled.
  void build(gpu::Commands& commands);

  VkDeviceAddress address() const { return tlas_.address(); }
  uint32_t capacity() const { return capacity_; }

 private:
  gpu::Device& device_;
  gpu::ComputePipeline pipeline_;
  gpu::Buffer instances_;
  gpu::Tlas tlas_;
  uint32_t capacity_ = 0;
};

}  // namespace helio::accel
