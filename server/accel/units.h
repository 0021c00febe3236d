// What moves in a world: where its units are and what they look like at a time of the world.
#pragma once

#include <span>
#include <vector>

#include "accel/clip_table.h"
#include "accel/instance_table.h"
#include "gpu/acceleration_structure.h"
#include "gpu/pipelines.h"
#include "gpu/range_pool.h"
#include "shared/animation.h"
#include "shared/history.h"

namespace helio::accel {

/// What a BLAS of an instance's own is made of, at one level of detail of its mesh.
struct DeformingLevel {
  uint32_t vertex_count = 0;                  ///< the mesh's first ones
  std::vector<gpu::BlasGeometry> geometries;  ///< with the positions at rest
  gpu::BlasSizes sizes;
  uint64_t triangles = 0;
};

/// What deforming a mesh takes.
struct DeformingMesh {
  VkDeviceAddress deform = 0;  ///< MeshDeform; 0: the mesh is rigid
  VkDeviceAddress rest = 0;    ///< positions at rest, 12 bytes apart
  std::vector<DeformingLevel> levels;
};

/// An instance that moves or deforms. Its index stays the same for its life.
struct Unit {
  uint32_t slot = scene::kNone;  ///< kNone: this entry is free
  uint32_t prefab = scene::kNone;
  uint32_t mesh = scene::kNone;
  glm::mat4x3 home{1.0f};
  const scene::Route* route = nullptr;
  double route_start = 0.0, route_speed = 0.0;  ///< metres, metres a second
  uint32_t clip = 0;
  double phase = 0.0;    ///< seconds of the clip at time 0
  bool posed = false;    ///< it has joints or morph weights
  gpu::Range pose;       ///< nodes, palette and weights
  gpu::Range previous;   ///< palette and weights of the tick before, while somebody looks back
  bool in_pose = false;  ///< the GPU has a pose of it
};

/// All costs are per unit, never per instance. Transforms are found on the CPU (culling needs them), joints on the GPU.
class Units {
 public:
  /// `meshes`: by mesh of the scene.
  Units(gpu::Device& device, const scene::Scene& scene, const ClipTable& clips, std::vector<DeformingMesh> meshes);

  /// Takes over what came, changed and went, after `table` did. `on_gone(index)` is called for each unit that is no
  /// more, before its index is used again.
  void apply(const world::ChangeSet& changes, const InstanceTable& table, const std::function<void(uint32_t)>& on_gone);
  /// Whether somebody looks back to where units were in the tick before: only then is it kept. Before pose().
  void lookBack(bool wanted);
  /// Where units were, for shaders (shared/history.h). After upload().
  void describe(shared::HistoryConstants& history) const;
  /// Brings every unit to where it is at `time`: a function of the time and the unit alone. False: nothing has changed
  /// since the last call.
  bool pose(double time, InstanceTable& table);
  /// After a tick that failed: the next pose() and upload() bring everything.
  void forget();

  /// Where a unit's deformed vertices and BLAS are in this tick; 0, 0, 0: rays do not meet it.
  void setBlas(uint32_t unit, VkDeviceAddress positions, uint32_t vertex_count, VkDeviceAddress blas);

  /// Records the copies (transfer writes). `table`: with this tick's places and levels of detail.
  void upload(gpu::Commands& commands, const InstanceTable& table);
  /// Compute: moved instances into the instance table, joints and weights of what is posed. After upload().
  void record(gpu::Commands& commands, const InstanceTable& table);

  /// Whether upload() and record() have something to do.
  bool dirty() const { return !moved_slots_.empty() || !poses_.empty() || deforms_dirty_; }
  const std::vector<Unit>& units() const { return units_; }  ///< by index, with free entries
  const DeformingMesh& meshOf(uint32_t unit) const { return meshes_[units_[unit].mesh]; }
  /// kNone: what stands in the slot neither moves nor deforms.
  uint32_t unitOf(uint32_t slot) const { return slot < unit_of_slot_.size() ? unit_of_slot_[slot] : scene::kNone; }
  bool deforms(uint32_t unit) const { return meshes_[units_[unit].mesh].deform != 0; }
  uint64_t count() const { return count_; }
  uint64_t cpuBytes() const {
    return units_.capacity() * (sizeof(Unit) + sizeof(shared::DeformRecord)) +
           (free_.capacity() + unit_of_slot_.capacity() + fresh_.capacity() + moved_slots_.capacity()) *
               sizeof(uint32_t) +
           moved_records_.capacity() * sizeof(shared::InstanceRecord) + poses_.capacity() * sizeof(shared::PoseRecord);
  }
  uint64_t bytes() const {
    return poses_pool_.bytesHeld() + deform_buffer_.size() + motion_buffer_.size() + unit_of_slot_buffer_.size();
  }

 private:
  void add(uint32_t slot, const world::Instance& instance);
  void remove(uint32_t index);
  void growTable();
  glm::mat4x3 transformAt(const Unit& unit, double time, double& clip_time) const;
  void addPose(Unit& unit, double clip_time);
  void keepPrevious(uint32_t index);
  void uploadUnitsOfSlots(gpu::Commands& commands);

  gpu::Device& device_;
  const scene::Scene& scene_;
  const ClipTable& clips_;
  std::vector<DeformingMesh> meshes_;
  std::vector<Unit> units_;
  std::vector<uint32_t> free_;
  std::vector<uint32_t> unit_of_slot_;  // kNone: none
  uint64_t count_ = 0;
  double time_ = 0.0;
  bool all_ = false;  // everything is new to the GPU

  gpu::RangePool poses_pool_;
  std::vector<shared::DeformRecord> deforms_;  // by unit
  gpu::Buffer deform_buffer_;
  bool deforms_dirty_ = false;
  std::vector<uint32_t> fresh_;  // units that came since the last pose()

  // Looking back.
  bool looks_back_ = false;
  bool moved_ = false;                // time went on at the last pose()
  gpu::Buffer motion_buffer_;         // shared::MotionRecord a unit
  gpu::Buffer unit_of_slot_buffer_;   // unit_of_slot_
  std::vector<uint32_t> unit_slots_;  // entries of it that changed
  bool unit_of_slot_dirty_ = false;   // all of it is to be uploaded
  VkDeviceAddress table_ = 0;         // of the instances, when they were last written

  // Of this tick.
  std::vector<uint32_t> moved_slots_;
  std::vector<shared::InstanceRecord> moved_records_;
  std::vector<shared::PoseRecord> poses_;
  gpu::Buffer tick_buffer_;
  std::vector<uint32_t> moved_units_;
  uint64_t units_at_ = 0, records_at_ = 0, poses_at_ = 0;

  gpu::ComputePipeline move_, pose_;
};

}  // namespace helio::accel
