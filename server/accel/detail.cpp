#include "accel/detail.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "shared/assemble.h"

namespace helio::accel {
namespace {

constexpr float kMargin = 1.3f;   // that a coarser level must be better than it need be
constexpr float kNever = 1e-30f;  // stands for what was allowed when nobody has looked yet
constexpr float kStale = 1.15f;   // change of the distance after which a block is looked at again

float stretchOf(const shared::InstanceRecord& record) {
  float longest = 0.0f;
  for (int axis = 0; axis < 3; ++axis)
    longest =
        std::max(longest, glm::length(glm::vec3(record.rows[0][axis], record.rows[1][axis], record.rows[2][axis])));
  return longest;
}

}  // namespace

void Detail::begin(std::span<const Viewpoint> viewers) {
  eyes_.clear();
  finest_ = std::any_of(viewers.begin(), viewers.end(),
                        [](const Viewpoint& v) { return v.everything || !(v.tolerance > 0.0f); });
  for (const Viewpoint& viewer : viewers) eyes_.push_back({viewer.volume.position, viewer.tolerance});
}

float Detail::allowed(const glm::vec3& centre, float radius) const {
  float least = std::numeric_limits<float>::max();
  for (const Eye& eye : eyes_)
    least = std::min(least, eye.tolerance * std::max(0.0f, glm::distance(eye.position, centre) - radius));
  return least;
}

uint32_t Detail::levelFor(const InstanceTable& table, uint32_t slot, uint32_t present) const {
  const PlacedInstance& placed = table.instances()[slot];
  const std::vector<scene::MeshLevel>& levels = scene_.meshes[placed.mesh].levels;
  if (finest_ || levels.empty()) return 0;
  if (eyes_.empty()) return present;
  const float most = allowed(placed.centre, placed.radius), stretch = stretchOf(table.records()[slot]);
  uint32_t level = 0;
  for (uint32_t l = 1; l <= levels.size(); ++l)
    if (levels[l - 1].error * stretch * (l > present ? kMargin : 1.0f) <= most) level = l;
  return level;
}

bool Detail::plan(InstanceTable& table, uint32_t slot) {
  const shared::InstanceRecord& record = table.records()[slot];
  const scene::Mesh& mesh = scene_.meshes[table.instances()[slot].mesh];
  if (mesh.levels.empty() || mesh.deforms()) return true;
  const uint32_t level = levelFor(table, slot, record.level);
  if (level == record.level) return true;
  const uint64_t triangles = (level == 0 ? mesh.indices : mesh.levels[level - 1].indices).size() / 3;
  if (left_.switches == 0 || left_.triangles < triangles) return false;
  --left_.switches;
  left_.triangles -= triangles;
  table.setLevel(slot, level);
  any_coarse_ |= level > 0;
  ++switched_;
  return true;
}

bool Detail::planBlock(InstanceTable& table, size_t block) {
  const size_t first = block * shared::kOrderBlock,
               end = std::min(table.order().size(), first + size_t{shared::kOrderBlock});
  for (size_t i = first; i < end; ++i)
    if (!table.travels(table.order()[i]) && !plan(table, table.order()[i])) return false;
  return true;
}

void Detail::place(InstanceTable& table, const world::ChangeSet& changes) {
  for (const auto& [slot, instance] : changes.slots) {
    const PlacedInstance& placed = table.instances()[slot];
    if (placed.prefab == scene::kNone || scene_.meshes[placed.mesh].deforms()) continue;
    const uint32_t level = levelFor(table, slot, 0);
    table.setLevel(slot, level);
    any_coarse_ |= level > 0;
  }
}

void Detail::plan(InstanceTable& table, const Units& units) {
  switched_ = 0;
  left_ = budget_;
  const std::vector<OrderBlock>& blocks = table.blocks();
  if (finest_) {
    if (any_coarse_)
      for (const uint32_t slot : table.order())
        if (!scene_.meshes[table.instances()[slot].mesh].deforms()) table.setLevel(slot, 0);
    any_coarse_ = false;
    looked_at_.clear();
    return;
  }
  if (eyes_.empty()) return;
  const auto allowedAt = [&](const OrderBlock& block) { return std::max(allowed(block.centre, block.radius), 1e-4f); };
  if (looked_at_.empty()) looked_at_.assign(blocks.size(), kNever);
  for (size_t b = looked_at_.size(); b < blocks.size(); ++b) looked_at_.push_back(allowedAt(blocks[b]));
  looked_at_.resize(blocks.size());

  // What moves; then the blocks whose distance changed most, the nearer first among equals.
  for (const Unit& unit : units.units())
    if (unit.slot != scene::kNone && table.travels(unit.slot) && !plan(table, unit.slot)) return;
  struct Due {
    float change, allowed;
    uint32_t block;
  };
  std::vector<Due> due;
  for (uint32_t b = 0; b < blocks.size(); ++b) {
    const float now = allowedAt(blocks[b]);
    const float change = std::max(now / looked_at_[b], looked_at_[b] / now);
    if (change > kStale) due.push_back({change, now, b});
  }
  const size_t count = std::min<size_t>(due.size(), budget_.blocks);
  std::partial_sort(due.begin(), due.begin() + static_cast<std::ptrdiff_t>(count), due.end(),
                    [](const Due& a, const Due& b) {
                      if (a.change != b.change) return a.change > b.change;
                      return a.allowed != b.allowed ? a.allowed < b.allowed : a.block < b.block;
                    });
  for (size_t i = 0; i < count; ++i) {
    if (!planBlock(table, due[i].block)) return;
    looked_at_[due[i].block] = due[i].allowed;
  }
}

}  // namespace helio::accel
