#include "world/instance_table.h"

#include "world/checksum.h"

namespace helio::world {

// An affine map takes the centre of a box to the centre of the mapped box's bounds, so one point is enough.
glm::vec2 centreXz(const scene::Scene& scene, uint32_t prefab, const glm::mat4x3& transform) {
  const glm::vec3 centre = scene.meshes[scene.prefabs[prefab].mesh].bounds.centre();
  const glm::vec3 placed = transform * glm::vec4(centre, 1.0f);
  return {placed.x, placed.z};
}

void InstanceTable::insert(InstanceId id, uint32_t prefab, const glm::mat4x3& transform) {
  uint32_t slot = slotCount();
  if (free_slots_.empty()) {
    slots_.emplace_back();
    is_dirty_.push_back(false);
  } else {
    slot = free_slots_.back();
    free_slots_.pop_back();
  }
  write(slot, {id, prefab, transform});
  slot_of_.emplace(id, slot);
  grid_.insert(slot, centreXz(scene_, prefab, transform));
  ++prefab_counts_[prefab];
}

void InstanceTable::remove(InstanceId id) {
  const auto entry = slot_of_.find(id);
  const uint32_t slot = entry->second;
  --prefab_counts_[slots_[slot].prefab];
  grid_.remove(slot);
  slot_of_.erase(entry);
  free_slots_.push_back(slot);
  write(slot, {});
}

void InstanceTable::move(InstanceId id, const glm::mat4x3& transform) {
  const uint32_t slot = slot_of_.at(id);
  const uint32_t prefab = slots_[slot].prefab;
  write(slot, {id, prefab, transform});
  grid_.remove(slot);
  grid_.insert(slot, centreXz(scene_, prefab, transform));
}

const Instance* InstanceTable::find(InstanceId id) const {
  const auto entry = slot_of_.find(id);
  return entry == slot_of_.end() ? nullptr : &slots_[entry->second];
}

std::vector<ChangeSet::Slot> InstanceTable::takeDirty() {
  std::vector<ChangeSet::Slot> taken;
  taken.reserve(dirty_slots_.size());
  for (uint32_t slot : dirty_slots_) {
    taken.push_back({slot, slots_[slot]});
    is_dirty_[slot] = false;
  }
  dirty_slots_.clear();
  return taken;
}

void InstanceTable::write(uint32_t slot, const Instance& instance) {
  checksum_ += hashOf(instance) - hashOf(slots_[slot]);
  slots_[slot] = instance;
  if (is_dirty_[slot]) return;
  is_dirty_[slot] = true;
  dirty_slots_.push_back(slot);
}

}  // namespace helio::world
