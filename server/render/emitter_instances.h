// The placed instances that shine, as a table to choose one from in proportion to power.
#pragma once

#include "accel/instance_table.h"
#include "gpu/memory.h"

namespace helio::render {

class EmitterInstances {
 public:
  explicit EmitterInstances(gpu::Device& device) : device_(device) {}

  /// Rebuilds the table from the instances that shine and records its upload.
  void upload(gpu::Commands& commands, const accel::InstanceTable& instances);

  VkDeviceAddress address() const { return buffer_.address(); }
  uint32_t count() const { return count_; }
  float weightSum() const { return weight_sum_; }
  uint64_t bytes() const { return buffer_.size(); }

 private:
  gpu::Device& device_;
  gpu::Buffer buffer_;
  uint32_t count_ = 0;
  float weight_sum_ = 0.0f;
};

}  // namespace helio::render
