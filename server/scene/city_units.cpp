#include "scene/city_units.h"

#include <algorithm>
#include <cmath>

#include "scene/random.h"

namespace helio::scene {
namespace {

constexpr double kSampling = 1.5;        // metres between points of a way: it follows the ground
constexpr float kLongestVehicle = 6.5f;  // metres of street that a vehicle needs, with room behind it

/// A way around a block, and how many units it should carry compared with others.
struct Way {
  Route route;
  bool street = false;
  bool reversed = false;
  double wish = 0.0;
};

Route wayAlong(const CityPlan& plan, const Polygon& polygon, double raise, bool reversed) {
  std::vector<glm::vec3> points;
  for (size_t i = 0; i < polygon.size(); ++i) {
    const glm::dvec2 a = polygon[i], b = polygon[(i + 1) % polygon.size()];
    const int steps = std::max(1, static_cast<int>(glm::distance(a, b) / kSampling));
    for (int k = 0; k < steps; ++k) {
      const glm::dvec2 p = glm::mix(a, b, static_cast<double>(k) / steps);
      points.emplace_back(glm::dvec3(p.x, plan.ground.height(p) + raise, p.y));
    }
  }
  if (reversed) std::reverse(points.begin(), points.end());
  return Route(std::move(points));
}

/// Insets of a block's edges, each as its street asks for.
template <typename Distance>
Polygon insetByStreet(const Polygon& polygon, const Block& block, Distance distance) {
  std::vector<double> insets;
  for (size_t i = 0; i < polygon.size(); ++i) {
    const glm::dvec2 a = polygon[i], b = polygon[(i + 1) % polygon.size()];
    insets.push_back(distance(block.streetAlong(a, b)));
  }
  return inset(polygon, insets);
}

std::vector<Way> waysOf(const CityPlan& plan) {
  const glm::dvec2 market = centroid(plan.blocks[plan.market].lot);
  std::vector<Way> ways;
  for (const Block& block : plan.blocks) {
    if (!block.builtUp() || block.kerb.size() < 3) continue;
    const double away = glm::distance(centroid(block.kerb), market);
    const double crowd = 1.0 + 5.0 * std::exp(-away / 60.0);
    const auto add = [&](const Polygon& polygon, double raise, bool street, bool reversed) {
      if (polygon.size() < 3) return;
      Way way{wayAlong(plan, polygon, raise, reversed), street, reversed, 0.0};
      if (way.route.length() < 25.0f) return;
      way.wish = static_cast<double>(way.route.length()) * crowd;
      ways.push_back(std::move(way));
    };
    const auto raise = static_cast<double>(block.raise);
    // Lamps and trees stand by the kerb, benches by the houses: people walk between them.
    add(insetByStreet(block.kerb, block, [](const Street& s) { return std::min(1.15, 0.45 * s.pavement + 0.2); }),
        raise, false, false);
    add(insetByStreet(block.kerb, block, [](const Street& s) { return std::min(1.8, 0.7 * s.pavement + 0.25); }), raise,
        false, true);
    if (block.use == Use::square)
      for (const double in : {4.0, 5.0, 6.0, 7.5}) add(inset(block.lot, in), raise, false, in == 5.0 || in == 7.5);
    add(insetByStreet(block.outline, block, [](const Street& s) { return std::max(1.1, 0.5 * s.half_width); }), 0.0,
        true, false);
  }
  return ways;
}

}  // namespace

Units placeUnits(const CityPlan& plan, const Catalogue& catalogue, size_t count) {
  Units units;
  if (count == 0) return units;
  std::vector<Way> ways = waysOf(plan);
  double walking = 0.0;
  for (const Way& way : ways) walking += way.street ? 0.0 : way.wish;
  Random random(hash64(plan.site.seed, 60));

  // Vehicles as far apart as they must be, at most one in ten units; the rest walks, spread by the ways' wishes.
  size_t vehicles_left = count / 10;
  std::vector<size_t> numbers(ways.size(), 0);
  for (size_t i = 0; i < ways.size() && vehicles_left > 0; ++i) {
    if (!ways[i].street) continue;
    numbers[i] = std::min(vehicles_left, static_cast<size_t>(ways[i].route.length() / (4.0f * kLongestVehicle)));
    vehicles_left -= numbers[i];
  }
  size_t walkers = count;
  for (const size_t number : numbers) walkers -= number;
  double wished = 0.0;
  for (size_t i = 0, placed = 0; i < ways.size(); ++i) {
    if (ways[i].street) continue;
    wished += ways[i].wish;
    const auto until = static_cast<size_t>(std::llround(static_cast<double>(walkers) * (wished / walking)));
    numbers[i] = until - placed;
    placed = until;
  }

  for (size_t i = 0; i < ways.size(); ++i) {
    if (numbers[i] == 0) continue;
    const float spacing = ways[i].route.length() / static_cast<float>(numbers[i]);
    // All on a way go at one pace: nobody walks through who is before them.
    const float speed = ways[i].street ? random.uniform(3.5f, 6.0f) : random.uniform(0.85f, 1.4f);
    const std::vector<uint32_t>& kinds = ways[i].street ? catalogue.vehicles : catalogue.walkers;
    for (size_t k = 0; k < numbers[i]; ++k) {
      Placement unit;
      unit.prefab = kinds[random.below(static_cast<uint32_t>(kinds.size()))];
      unit.route = static_cast<uint32_t>(units.routes.size());
      unit.route_start = spacing * (static_cast<float>(k) + random.uniform(0.0f, 0.4f));
      unit.route_speed = speed;
      unit.transform = ways[i].route.at(static_cast<double>(unit.route_start));
      units.placements.push_back(unit);
    }
    units.routes.push_back(std::move(ways[i].route));
  }
  return units;
}

}  // namespace helio::scene
