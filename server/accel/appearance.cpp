#include "accel/appearance.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "accel/strategy.h"

namespace helio::accel {
namespace {

constexpr float kCutMetres = shared::kCellMetres;  // in one tick: no flight, a jump
constexpr float kCutCosine = 0.8f;                 // of the turn of a frustum's side

/// A sight is a frustum with a margin of the volume's radius on all sides: what stands beside a picture lights it and
/// casts shadows into it.
bool touches(const shared::CullVolume& volume, const glm::vec3& centre, float radius) {
  return inFrustum(volume, centre, radius + volume.radius);
}

bool contains(const shared::CullVolume& volume, const glm::vec3& centre, float radius) {
  return inFrustum(volume, centre, volume.radius - radius);
}

bool same(const shared::CullVolume& a, const shared::CullVolume& b) {
  return a.position == b.position && a.radius == b.radius && std::equal(a.sides, std::end(a.sides), b.sides);
}

bool isCut(const shared::CullVolume& before, const shared::CullVolume& now) {
  return glm::distance(before.position, now.position) > kCutMetres ||
         glm::dot(before.sides[0], now.sides[0]) < kCutCosine || glm::dot(before.sides[2], now.sides[2]) < kCutCosine;
}

/// Pixels of a picture of 1920 x 1080 that a sphere covers, about.
float pixelsOf(const shared::CullVolume& volume, float radius, float distance) {
  // Normals of opposite sides, whose half angle has the tangent t, have the product (t^2 - 1) / (t^2 + 1).
  const auto squareTangent = [&](int side) {
    const float product = glm::dot(volume.sides[side], volume.sides[side + 1]);
    return (1.0f + product) / (1.0f - product);
  };
  const float share = radius / std::max(distance, radius);
  const float picture = 4.0f * std::sqrt(squareTangent(0) * squareTangent(2));
  return static_cast<float>(shared::kReferencePaths) * 3.14159265f * share * share / std::max(picture, 1e-9f);
}

bool reachable(float threshold) { return threshold <= LipacSettings::kHighestThreshold; }

}  // namespace

void Appearance::findBlocks(const Sight& sight, uint32_t index, Viewer& viewer, const InstanceTable& table,
                            std::vector<Ranked>& ranked) {
  const bool moved = !viewer.known || !same(viewer.before, sight.volume);
  if (!moved && viewer.waiting.empty()) return;
  const std::vector<OrderBlock>& blocks = table.blocks();
  const auto consider = [&](uint32_t b) {
    ++visits_;
    if (b >= blocks.size() || blocks[b].radius < 0.0f) return;
    const OrderBlock& block = blocks[b];
    const bool waited = viewer.waiting.contains(b);
    if (!touches(sight.volume, block.centre, block.radius)) return;
    if (!waited && viewer.known && contains(viewer.before, block.centre, block.radius)) return;
    const float nearest = glm::distance(block.centre, sight.volume.position) - block.radius;
    const float pixels = pixelsOf(sight.volume, 0.5f * static_cast<float>(shared::kCellMetres), nearest);
    if (pixels < settings_.box_deactivate) return;
    ranked.push_back({pixels, {b | (waited || !viewer.known ? shared::kSightWhole : 0u), index}});
  };
  if (moved)
    for (uint32_t b = 0; b < blocks.size(); ++b) consider(b);
  else
    for (const uint32_t b : viewer.waiting) consider(b);
  viewer.waiting.clear();
}

void Appearance::begin(std::span<const Sight> sights, std::span<const uint32_t> edited, const InstanceTable& table,
                       const Units& units) {
  blocks_.clear();
  volumes_.clear();
  units_.clear();
  slots_.clear();
  visits_ = 0;
  if (smoothing_ < settings_.smoothing) ++smoothing_;
  if (!settings_.mitigation || !reachable(settings_.box_activate)) return;

  std::vector<Ranked> ranked;
  std::vector<std::pair<float, uint32_t>> ranked_units;
  for (uint32_t i = 0; i < sights.size(); ++i) {
    Sight sight = sights[i];
    sight.volume.radius = settings_.sight_radius;
    Viewer& viewer = viewers_[sight.viewer];
    volumes_.push_back(sight.volume);
    volumes_.push_back(viewer.before);
    if (!viewer.known || isCut(viewer.before, sight.volume)) smoothing_ = 1;
    findBlocks(sight, i, viewer, table, ranked);

    if (viewer.known)
      for (const uint32_t slot : edited) {
        const PlacedInstance& placed = table.instances()[slot];
        ++visits_;
        if (placed.prefab != scene::kNone && touches(sight.volume, placed.centre, placed.radius))
          slots_.push_back(slot);
      }

    viewer.seen_units.resize(units.units().size());
    for (uint32_t unit = 0; unit < units.units().size() && reachable(settings_.own_activate); ++unit) {
      if (units.units()[unit].slot == scene::kNone || !units.deforms(unit)) continue;
      ++visits_;
      const PlacedInstance& placed = table.instances()[units.units()[unit].slot];
      if (!touches(sight.volume, placed.centre, placed.radius)) {
        viewer.seen_units[unit] = false;
      } else if (!viewer.seen_units[unit]) {
        const float pixels = pixelsOf(sight.volume, placed.radius, glm::distance(placed.centre, sight.volume.position));
        if (pixels >= settings_.own_deactivate) ranked_units.emplace_back(-pixels, unit);
      }
    }
    viewer.known = true;
    viewer.before = sight.volume;
  }

  std::sort(ranked.begin(), ranked.end(), [](const Ranked& a, const Ranked& b) {
    if (a.pixels != b.pixels) return a.pixels > b.pixels;
    return a.sight.viewer != b.sight.viewer ? a.sight.viewer < b.sight.viewer : a.sight.block < b.sight.block;
  });
  for (size_t i = 0; i < ranked.size(); ++i) {
    const shared::LipacSight& sight = ranked[i].sight;
    if (i < settings_.sight_blocks) blocks_.push_back(sight);
    else viewers_[sights[sight.viewer].viewer].waiting.insert(sight.block & ~shared::kSightWhole);
  }
  std::sort(ranked_units.begin(), ranked_units.end());
  std::vector<bool> listed(units.units().size());
  for (const auto& [pixels, unit] : ranked_units) {
    if (!listed[unit]) units_.push_back(unit);
    listed[unit] = true;
  }
}

void Appearance::noteShown(uint32_t unit) {
  for (auto& [handle, viewer] : viewers_)
    if (unit < viewer.seen_units.size()) viewer.seen_units[unit] = true;
}

}  // namespace helio::accel
