// The instances of a world: their records on the GPU, and the order in which they enter the TLAS.
#pragma once

#include <functional>
#include <vector>

#include "gpu/commands.h"
#include "gpu/memory.h"
#include "scene/scene.h"
#include "shared/scene.h"
#include "world/world.h"

namespace helio::accel {

/// What the CPU knows of an instance between ticks.
struct PlacedInstance {
  uint32_t prefab = scene::kNone;
  uint32_t mesh = scene::kNone;
  glm::vec3 centre{0.0f};  ///< of its bounding sphere, world space
  float radius = 0.0f;
};

/// Bounds of shared::kOrderBlock neighbours in the order; a radius below 0: nothing is there.
struct OrderBlock {
  glm::vec3 centre{0.0f};
  float radius = -1.0f;
};

/// The placement whose way a base instance goes along; null when it has none, or when somebody moved it.
const scene::Placement* routedPlacement(const scene::Scene& scene, const world::Instance& instance);

/// Mirror of a world's slots. The Morton order is over the ground plane, the hitboxes' order: lavapipe does not sort
/// its TLAS, and neighbours in memory are neighbours in space for every later pass.
class InstanceTable {
 public:
  /// `emitter_power`: by mesh, for InstanceRecord::emitter_weight (0: nothing shines); `weigh` scales it by a
  /// transform.
  InstanceTable(gpu::Device& device, const scene::Scene& scene, std::vector<float> emitter_power,
                float (*weigh)(float power, const glm::mat4x3& transform));

  /// Takes over what changed: CPU side only. `on_change(prefab, +1 or -1)` is called for each instance placed or
  /// removed.
  void apply(const world::ChangeSet& changes, const std::function<void(uint32_t prefab, int64_t count)>& on_change);
  /// What users changed since the last upload().
  bool dirty() const { return upload_all_ || !dirty_slots_.empty(); }
  /// The order changed since the last upload(), by what users did or because something moved.
  bool orderDirty() const { return dirty() || travellers_dirty_ || !switched_slots_.empty(); }

  /// Whether the slot's instance has a place of its own in every tick: those stand behind all others in the order.
  bool travels(uint32_t slot) const { return travels_[slot]; }
  /// Where an instance is in this tick. The record is not marked for upload(): Units brings it to the GPU.
  void place(uint32_t slot, const glm::mat4x3& transform, VkDeviceAddress deform);
  /// Which level of detail of the instance's mesh rays meet.
  void setLevel(uint32_t slot, uint32_t level);
  /// Orders what travels anew, after it was placed.
  void sortTravellers();
  /// After a tick that failed: the next upload() brings everything.
  void forget();
  /// Something that shines was placed, moved or removed since the last upload().
  bool emittersDirty() const { return emitters_dirty_; }
  /// Records the copies of changed records and of the order (transfer writes); grows the buffers if need be.
  void upload(gpu::Commands& commands);

  const std::vector<PlacedInstance>& instances() const { return placed_; }  ///< by slot
  const std::vector<shared::InstanceRecord>& records() const { return records_; }
  const std::vector<uint32_t>& order() const { return order_; }
  const std::vector<OrderBlock>& blocks() const { return blocks_; }
  /// Slots of a block, one a mesh of those in it that do not deform.
  const std::vector<uint32_t>& kindsIn(uint32_t block) const { return kinds_[block]; }
  uint64_t bytes() const { return record_buffer_.size() + order_buffer_.size(); }
  uint64_t cpuBytes() const {
    return placed_.capacity() * (sizeof(PlacedInstance) + sizeof(shared::InstanceRecord) + sizeof(uint64_t)) +
           (order_.capacity() + dirty_slots_.capacity() + switched_slots_.capacity()) * sizeof(uint32_t) +
           blocks_.capacity() * sizeof(OrderBlock) + travels_.capacity() / 8;
  }
  const gpu::Buffer& recordBuffer() const { return record_buffer_; }
  const gpu::Buffer& orderBuffer() const { return order_buffer_; }

 private:
  uint64_t mortonKey(const glm::vec3& centre) const;
  void rebuildOrder(const world::ChangeSet& changes);
  void setTransform(uint32_t slot, const glm::mat4x3& transform);
  void boundBlocks(size_t from_entry);
  bool before(uint32_t a, uint32_t b) const { return keys_[a] != keys_[b] ? keys_[a] < keys_[b] : a < b; }

  gpu::Device& device_;
  const scene::Scene& scene_;
  std::vector<float> emitter_power_;
  float (*weigh_)(float, const glm::mat4x3&);
  std::vector<PlacedInstance> placed_;
  std::vector<shared::InstanceRecord> records_;
  std::vector<uint64_t> keys_;   // by slot
  std::vector<bool> travels_;    // by slot
  std::vector<uint32_t> order_;  // slots by (key, slot): those that stand, then those that travel
  size_t standing_ = 0;          // of order_
  std::vector<OrderBlock> blocks_;
  std::vector<std::vector<uint32_t>> kinds_;  // by block
  bool travellers_dirty_ = false;
  std::vector<uint32_t> dirty_slots_;
  std::vector<uint32_t> switched_slots_;  // their levels alone changed
  bool emitters_dirty_ = false;
  bool upload_all_ = false;
  gpu::Buffer record_buffer_;
  gpu::Buffer order_buffer_;
};

}  // namespace helio::accel
