// The TLAS of a world, and with light path guided culling a second one for rays that count, in which boxes stand for
// what is culled: instances written on the GPU in Morton order, then built.
#pragma once

#include "accel/instance_table.h"
#include "accel/shared_blases.h"
#include "accel/strategy.h"
#include "gpu/acceleration_structure.h"
#include "gpu/pipelines.h"

namespace helio::accel {

/// Instances that a TLAS is built from.
struct TlasTable {
  VkDeviceAddress instances = 0;  ///< TlasInstance
  uint32_t capacity = 0;
};
/// Instances that want a place in each TLAS.
struct TlasRoom {
  uint32_t surfaces = 0;  ///< 0: every ray counts, so the other one will do
  uint32_t counted = 0;
};

class TlasAssembly {
 public:
  /// `mesh_bounds`: by mesh of the scene.
  TlasAssembly(gpu::Device& device, gpu::Commands& commands, const scene::Scene& scene);

  /// Chooses the blocks of the order that the strategy does not rule out, and sizes the instance buffer for them: the
  /// next bucket above 1.125 times their instances, so that the build count changes seldom; what lies behind is null.
  /// Gives back what edits leave over, once they have been over for a while.
  void reserve(gpu::Commands& commands, const InstanceTable& table, const CullingStrategy& strategy);
  /// The same for so many entries, which somebody else writes to surfaces() and counted(), and who is untraced to a
  /// table of its own.
  void reserve(gpu::Commands& commands, const TlasRoom& room);
  TlasTable surfaces() const { return surfaces_.table(); }  ///< of no capacity where the other one will do
  TlasTable counted() const { return counted_.table(); }
  /// Records the copies of what assemble() reads (transfer writes). After reserve().
  void upload(gpu::Commands& commands);
  /// Compute: writes surfaces() from the table, in its order, and notes which BLASes they need.
  void assemble(gpu::Commands& commands, const InstanceTable& table, const SharedBlases& blases);
  /// Builds the structures from what was assembled, and reads back how many entered.
  void build(gpu::Commands& commands);

  /// For rays that do not count; 0: none was ever built.
  VkDeviceAddress address() const { return (surfaces_.capacity > 0 ? surfaces_ : counted_).tlas.address(); }
  VkDeviceAddress countedAddress() const { return counted_.tlas.address(); }
  /// By slot: 0 where rays meet the instance, as the last assemble() had it.
  const gpu::Buffer& untraced() const { return untraced_; }
  /// Of the last build that is done.
  uint32_t entered() const;
  uint64_t bytes() const { return surfaces_.bytes() + counted_.bytes() + untraced_.size(); }
  uint64_t scratchBytes() const { return surfaces_.tlas.scratchBytes() + counted_.tlas.scratchBytes(); }

 private:
  struct Part {
    const char* name;
    gpu::Buffer instances;
    gpu::Tlas tlas;
    uint32_t capacity = 0;
    uint32_t roomy_ticks = 0;  // for which a smaller capacity would have done

    TlasTable table() const { return {instances ? instances.address() : 0, capacity}; }
    uint64_t bytes() const { return instances.size() + tlas.bytes(); }
  };
  void reserve(gpu::Commands& commands, Part& part, uint32_t count);
  void drop(gpu::Commands& commands, Part& part);

  gpu::Device& device_;
  gpu::ComputePipeline pipeline_;
  gpu::Buffer spheres_, chosen_buffer_, volume_buffer_, counter_, counter_readback_, untraced_;
  Part surfaces_{"the TLAS instances"}, counted_{"the TLAS instances with boxes"};
  std::vector<uint32_t> chosen_;  // blocks, ascending
  bool all_blocks_ = true;
  std::vector<shared::CullVolume> volumes_;
  bool culls_ = false;
};

}  // namespace helio::accel
