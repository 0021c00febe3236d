// The TLAS of a world: instances written on the GPU in Morton order, then built.
#pragma once

#include "accel/instance_table.h"
#include "accel/shared_blases.h"
#include "accel/strategy.h"
#include "gpu/acceleration_structure.h"
#include "gpu/pipelines.h"

namespace helio::accel {

class TlasAssembly {
 public:
  /// `mesh_bounds`: by mesh of the scene.
  TlasAssembly(gpu::Device& device, gpu::Commands& commands, const scene::Scene& scene);

  /// Chooses the blocks of the order that the strategy does not rule out, and sizes the instance buffer for them: the
  /// next bucket above 1.125 times their instances, so that the build count changes seldom; what lies behind is null.
  /// Gives back what edits leave over, once they have been over for a while.
  void reserve(gpu::Commands& commands, const InstanceTable& table, const CullingStrategy& strategy);
  /// The same for so many entries, which somebody else writes to output(), and who is untraced to a table of its own.
  void reserve(gpu::Commands& commands, uint32_t count);
  VkDeviceAddress output() const { return instances_.address(); }
  /// Records the copies of what assemble() reads (transfer writes). After reserve().
  void upload(gpu::Commands& commands);
  /// Compute: writes `capacity()` TLAS instances from the table, in its order, and notes which BLASes they need.
  void assemble(gpu::Commands& commands, const InstanceTable& table, const SharedBlases& blases);
  /// Builds the structure from what was assembled, and reads back how many entered.
  void build(gpu::Commands& commands);

  VkDeviceAddress address() const { return tlas_.address(); }
  /// By slot: 0 where rays meet the instance, as the last assemble() had it.
  const gpu::Buffer& untraced() const { return untraced_; }
  uint32_t capacity() const { return capacity_; }
  /// Of the last build that is done.
  uint32_t entered() const;
  uint64_t bytes() const { return tlas_.bytes() + instances_.size() + untraced_.size(); }
  uint64_t scratchBytes() const { return tlas_.scratchBytes(); }

 private:
  gpu::Device& device_;
  gpu::ComputePipeline pipeline_;
  gpu::Buffer spheres_, instances_, chosen_buffer_, volume_buffer_, counter_, counter_readback_, untraced_;
  gpu::Tlas tlas_;
  std::vector<uint32_t> chosen_;  // blocks, ascending
  bool all_blocks_ = true;
  std::vector<shared::CullVolume> volumes_;
  bool culls_ = false;
  uint32_t capacity_ = 0;
  uint32_t roomy_ticks_ = 0;  // for which a smaller capacity would have done
};

}  // namespace helio::accel
