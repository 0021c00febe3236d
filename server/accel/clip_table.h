// The rigs' clips on the GPU: what animate/pose.comp samples. Immutable after upload.
#pragma once

#include <vector>

#include "gpu/commands.h"
#include "gpu/memory.h"
#include "scene/scene.h"

namespace helio::accel {

class ClipTable {
 public:
  /// Records the upload.
  ClipTable(gpu::Device& device, gpu::Commands& commands, const scene::Scene& scene);

  VkDeviceAddress clip(uint32_t rig, uint32_t clip) const { return addresses_[rig][clip]; }
  VkDeviceAddress ground() const { return ground_; }  ///< GroundRecord; 0: the scene has none

 private:
  gpu::Buffer buffer_;
  std::vector<std::vector<VkDeviceAddress>> addresses_;
  VkDeviceAddress ground_ = 0;
};

}  // namespace helio::accel
