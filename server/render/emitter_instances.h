// The placed instances that shine and the punctual lights, as tables to choose one from: among all by power, and by
// cell of the ground plane.
#pragma once

#include "accel/instance_table.h"
#include "gpu/memory.h"
#include "shared/frame.h"

namespace helio::render {

class EmitterInstances {
 public:
  EmitterInstances(gpu::Device& device, const scene::Scene& scene) : device_(device), punctual_(scene.lights) {}

  /// No tables were made yet.
  bool empty() const { return !made_; }
  /// Rebuilds the tables from the instances that shine and records their upload.
  void upload(gpu::Commands& commands, const accel::InstanceTable& instances);
  /// Fills in what light sampling needs.
  void describe(shared::FrameConstants& constants) const;
  /// Of the light grid: its cells, and their table on the GPU.
  uint32_t cells() const { return grid_size_.x * grid_size_.y; }
  VkDeviceAddress cellTable() const { return cells_.address(); }
  /// Another number whenever the tables were made anew.
  uint64_t version() const { return version_; }
  uint64_t bytes() const { return instances_.size() + cells_.size() + punctual_records_.size(); }

 private:
  void store(gpu::Commands& commands, gpu::Buffer& buffer, const std::string& name,
             std::span<const std::byte> bytes) const;

  gpu::Device& device_;
  const std::vector<scene::PunctualLight>& punctual_;
  bool made_ = false;
  uint64_t version_ = 0;
  gpu::Buffer instances_;
  gpu::Buffer cells_;
  gpu::Buffer punctual_records_;
  uint32_t count_ = 0;
  float weight_sum_ = 0.0f;
  float distant_irradiance_ = 0.0f;
  glm::vec2 grid_origin_{0.0f};
  glm::uvec2 grid_size_{0u};
  float cells_per_metre_ = 0.0f;
};

}  // namespace helio::render
