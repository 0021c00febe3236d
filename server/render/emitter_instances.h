// The placed instances that shine, as tables to choose one from: among all by power, and by cell of the ground plane.
#pragma once

#include "accel/instance_table.h"
#include "gpu/memory.h"
#include "shared/frame.h"

namespace helio::render {

class EmitterInstances {
 public:
  explicit EmitterInstances(gpu::Device& device) : device_(device) {}

  /// Rebuilds the tables from the instances that shine and records their upload.
  void upload(gpu::Commands& commands, const accel::InstanceTable& instances);
  /// Fills in what light sampling needs.
  void describe(shared::FrameConstants& constants) const;
  uint64_t bytes() const { return instances_.size() + cells_.size(); }

 private:
  void store(gpu::Commands& commands, gpu::Buffer& buffer, const std::string& name,
             std::span<const std::byte> bytes) const;

  gpu::Device& device_;
  gpu::Buffer instances_;
  gpu::Buffer cells_;
  uint32_t count_ = 0;
  float weight_sum_ = 0.0f;
  glm::vec2 grid_origin_{0.0f};
  glm::uvec2 grid_size_{0u};
  float cells_per_metre_ = 0.0f;
};

}  // namespace helio::render
