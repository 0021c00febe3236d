// The instances of a world: dense slots for the renderer, ids for users, places for region queries.
#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

#include "world/grid.h"
#include "world/world.h"

namespace helio::world {

/// Where an instance counts as being: the x and z of its bounds' centre, metres.
glm::vec2 centreXz(const scene::Scene& scene, uint32_t prefab, const glm::mat4x3& transform);

/// Slots are reused, ids are not. Every slot that was written since the last takeDirty() is remembered once. Not
/// thread-safe. Prefabs must be in the scene's range, ids and slots must be live where they are asked for: callers
/// check.
class InstanceTable {
 public:
  explicit InstanceTable(const scene::Scene& scene) : scene_(scene), prefab_counts_(scene.prefabs.size()) {}

  void insert(InstanceId id, uint32_t prefab, const glm::mat4x3& transform);
  void remove(InstanceId id);
  void move(InstanceId id, const glm::mat4x3& transform);

  /// The live instance of this id, or null.
  const Instance* find(InstanceId id) const;
  const Instance& at(uint32_t slot) const { return slots_[slot]; }
  const HitboxGrid& grid() const { return grid_; }

  uint64_t liveCount() const { return slot_of_.size(); }
  uint32_t slotCount() const { return static_cast<uint32_t>(slots_.size()); }
  const std::vector<uint32_t>& prefabCounts() const { return prefab_counts_; }

  /// The sum of the hashes of all live instances, kept as they come, move and go; see World::checksum().
  uint64_t checksum() const { return checksum_; }

  /// Copies of the slots written since the last call, in the order first written.
  std::vector<ChangeSet::Slot> takeDirty();

 private:
  void write(uint32_t slot, const Instance& instance);

  const scene::Scene& scene_;
  std::vector<Instance> slots_;
  std::vector<uint32_t> free_slots_;
  std::unordered_map<InstanceId, uint32_t> slot_of_;
  HitboxGrid grid_;  // items are slots
  std::vector<uint32_t> prefab_counts_;
  std::vector<uint32_t> dirty_slots_;
  std::vector<bool> is_dirty_;  // by slot
  uint64_t checksum_ = 0;
};

}  // namespace helio::world
