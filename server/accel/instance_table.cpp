#include "accel/instance_table.h"

#include <algorithm>
#include <cmath>

#include "shared/assemble.h"

namespace helio::accel {
namespace {

/// Spreads the lower 32 bits of x to the even bits.
uint64_t spread(uint64_t x) {
  x &= 0xffffffffull;
  x = (x | x << 16) & 0x0000ffff0000ffffull;
  x = (x | x << 8) & 0x00ff00ff00ff00ffull;
  x = (x | x << 4) & 0x0f0f0f0f0f0f0f0full;
  x = (x | x << 2) & 0x3333333333333333ull;
  x = (x | x << 1) & 0x5555555555555555ull;
  return x;
}

bool invertible(const glm::mat4x3& transform) { return std::isnormal(glm::determinant(glm::mat3(transform))); }

/// Grows to a power of two, so that edits seldom reallocate.
uint64_t capacityFor(uint64_t count) {
  uint64_t capacity = 1024;
  while (capacity < count) capacity *= 2;
  return capacity;
}

}  // namespace

const scene::Placement* routedPlacement(const scene::Scene& scene, const world::Instance& instance) {
  if (instance.id == 0 || instance.id > scene.placements.size()) return nullptr;
  const scene::Placement& placed = scene.placements[instance.id - 1];
  return placed.route != scene::kNone && placed.transform == instance.transform ? &placed : nullptr;
}

InstanceTable::InstanceTable(gpu::Device& device, const scene::Scene& scene, std::vector<float> emitter_power,
                             float (*weigh)(float, const glm::mat4x3&))
    : device_(device), scene_(scene), emitter_power_(std::move(emitter_power)), weigh_(weigh) {}

uint64_t InstanceTable::mortonKey(const glm::vec3& centre) const {
  // 1/16 m steps from -2^27 m on: finer than any two instances need, wider than any world.
  const auto step = [](float v) { return static_cast<uint64_t>((static_cast<double>(v) + 134217728.0) * 16.0); };
  return spread(step(centre.x)) | spread(step(centre.z)) << 1;
}

void InstanceTable::apply(const world::ChangeSet& changes, const std::function<void(uint32_t, int64_t)>& on_change) {
  if (changes.slot_count > placed_.size()) {
    placed_.resize(changes.slot_count);
    records_.resize(changes.slot_count, {{}, shared::kNoMesh, 0.0f, 0});
    keys_.resize(changes.slot_count);
    travels_.resize(changes.slot_count);
  }
  for (const auto& [slot, instance] : changes.slots) {
    PlacedInstance& placed = placed_[slot];
    shared::InstanceRecord& record = records_[slot];
    // Rays cannot meet what is scaled to nothing [Vulkan: the transform must be invertible], so raster must not either.
    const uint32_t prefab = invertible(instance.transform) ? instance.prefab : scene::kNone;
    if (placed.prefab != prefab) {
      if (placed.prefab != scene::kNone) on_change(placed.prefab, -1);
      if (prefab != scene::kNone) on_change(prefab, +1);
    }
    dirty_slots_.push_back(slot);
    emitters_dirty_ |= record.emitter_weight > 0.0f;
    record.deform = 0;
    record.level = 0;
    travels_[slot] = false;
    if (prefab == scene::kNone) {
      placed = {};
      record.mesh = shared::kNoMesh;
      record.emitter_weight = 0.0f;
      continue;
    }
    placed.prefab = prefab;
    placed.mesh = scene_.prefabs[prefab].mesh;
    record.mesh = placed.mesh;
    record.emitter_weight =
        emitter_power_[placed.mesh] > 0.0f ? weigh_(emitter_power_[placed.mesh], instance.transform) : 0.0f;
    emitters_dirty_ |= record.emitter_weight > 0.0f;
    travels_[slot] = scene_.prefabs[prefab].node != scene::kNone || routedPlacement(scene_, instance) != nullptr;
    setTransform(slot, instance.transform);
  }
  if (!changes.slots.empty()) rebuildOrder(changes);
}

void InstanceTable::setTransform(uint32_t slot, const glm::mat4x3& transform) {
  PlacedInstance& placed = placed_[slot];
  const scene::Aabb bounds = scene::transform(scene_.meshes[placed.mesh].bounds, transform);
  placed.centre = bounds.centre();
  placed.radius = 0.5f * glm::length(bounds.extent());
  for (int row = 0; row < 3; ++row)
    records_[slot].rows[row] = {transform[0][row], transform[1][row], transform[2][row], transform[3][row]};
  keys_[slot] = mortonKey(placed.centre);
}

void InstanceTable::place(uint32_t slot, const glm::mat4x3& transform, VkDeviceAddress deform) {
  // Scaled to nothing for the moment: neither rays nor the rasteriser meet a point.
  setTransform(slot, invertible(transform) ? transform : glm::mat4x3(0.0f));
  records_[slot].deform = deform;
}

void InstanceTable::setLevel(uint32_t slot, uint32_t level) {
  if (records_[slot].level == level) return;
  records_[slot].level = level;
  switched_slots_.push_back(slot);
}

void InstanceTable::sortTravellers() {
  if (standing_ == order_.size()) return;
  std::sort(order_.begin() + static_cast<ptrdiff_t>(standing_), order_.end(),
            [this](uint32_t a, uint32_t b) { return before(a, b); });
  boundBlocks(standing_);
  travellers_dirty_ = true;
}

void InstanceTable::boundBlocks(size_t from_entry) {
  constexpr size_t kBlock = shared::kOrderBlock;
  blocks_.resize((order_.size() + kBlock - 1) / kBlock);
  kinds_.resize(blocks_.size());
  for (size_t b = from_entry / kBlock; b < blocks_.size(); ++b) {
    scene::Aabb bounds;
    std::vector<uint32_t>& kinds = kinds_[b];
    kinds.clear();
    const size_t end = std::min(order_.size(), (b + 1) * kBlock);
    for (size_t i = b * kBlock; i < end; ++i) {
      const PlacedInstance& placed = placed_[order_[i]];
      bounds.grow({placed.centre - placed.radius, placed.centre + placed.radius});
      if (!scene_.meshes[placed.mesh].deforms() &&
          std::none_of(kinds.begin(), kinds.end(), [&](uint32_t slot) { return placed_[slot].mesh == placed.mesh; }))
        kinds.push_back(order_[i]);
    }
    blocks_[b] = {bounds.centre(), 0.5f * glm::length(bounds.extent())};
  }
}

void InstanceTable::rebuildOrder(const world::ChangeSet& changes) {
  // Take out what was removed or placed anew, then merge the sorted newcomers: linear in the instances, once an edit.
  std::vector<bool> changed(placed_.size());
  std::vector<uint32_t> newcomers, travellers(order_.begin() + static_cast<ptrdiff_t>(standing_), order_.end());
  for (const auto& [slot, instance] : changes.slots) changed[slot] = true;
  order_.resize(standing_);
  const auto is_changed = [&](uint32_t slot) { return changed[slot]; };
  std::erase_if(order_, is_changed);
  std::erase_if(travellers, is_changed);
  for (const auto& [slot, instance] : changes.slots)
    if (placed_[slot].prefab != scene::kNone) (travels_[slot] ? travellers : newcomers).push_back(slot);
  const auto earlier = [this](uint32_t a, uint32_t b) { return before(a, b); };
  std::sort(newcomers.begin(), newcomers.end(), earlier);
  const auto middle = static_cast<ptrdiff_t>(order_.size());
  order_.insert(order_.end(), newcomers.begin(), newcomers.end());
  std::inplace_merge(order_.begin(), order_.begin() + middle, order_.end(), earlier);
  standing_ = order_.size();
  std::sort(travellers.begin(), travellers.end(), earlier);
  order_.insert(order_.end(), travellers.begin(), travellers.end());
  boundBlocks(0);
}

void InstanceTable::forget() { upload_all_ = emitters_dirty_ = true; }

void InstanceTable::upload(gpu::Commands& commands) {
  const bool edited = dirty();
  dirty_slots_.insert(dirty_slots_.end(), switched_slots_.begin(), switched_slots_.end());
  std::sort(dirty_slots_.begin(), dirty_slots_.end());
  const uint64_t record_bytes = capacityFor(records_.size()) * sizeof(shared::InstanceRecord);
  if (record_buffer_.size() < record_bytes) upload_all_ = true;
  if (upload_all_) {
    if (record_buffer_) commands.retire(std::move(record_buffer_));
    record_buffer_ = gpu::Buffer(device_, {"the instance table", record_bytes, gpu::MemoryCategory::raster});
    commands.upload<shared::InstanceRecord>(record_buffer_, 0, records_);
  } else {
    // Neighbouring slots travel together.
    for (size_t i = 0; i < dirty_slots_.size();) {
      size_t end = i + 1;
      while (end < dirty_slots_.size() && dirty_slots_[end] <= dirty_slots_[end - 1] + 1) ++end;
      const uint32_t first = dirty_slots_[i];
      const uint32_t count = dirty_slots_[end - 1] - first + 1;
      commands.upload<shared::InstanceRecord>(record_buffer_, first, std::span(records_).subspan(first, count));
      i = end;
    }
  }
  const uint64_t order_bytes = capacityFor(order_.size()) * sizeof(uint32_t);
  if (order_buffer_.size() < order_bytes) {
    if (order_buffer_) commands.retire(std::move(order_buffer_));
    order_buffer_ = gpu::Buffer(device_, {"the Morton order", order_bytes, gpu::MemoryCategory::ray_tracing});
    upload_all_ = true;
  }
  // Where nothing but what travels moved, the rest of the order is there already.
  const size_t first = edited || upload_all_ ? 0 : standing_;
  commands.upload<uint32_t>(order_buffer_, first, std::span<const uint32_t>(order_).subspan(first));
  dirty_slots_.clear();
  switched_slots_.clear();
  emitters_dirty_ = upload_all_ = travellers_dirty_ = false;
}

}  // namespace helio::accel
