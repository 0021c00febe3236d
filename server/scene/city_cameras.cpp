#include "scene/city_cameras.h"

#include <algorithm>
#include <cmath>

#include "scene/random.h"

namespace helio::scene {
namespace {

constexpr float kDegree = 0.017453292f;
constexpr float kFieldOfView = 50.0f * kDegree;

/// Looks from `position`, `height` metres above its ground, at a point `target_height` metres above that of `target`.
Camera lookAt(const CityPlan& plan, const glm::dvec2& position, double height, const glm::dvec2& target,
              double target_height) {
  const glm::dvec3 from(position.x, plan.ground.height(position) + height, position.y);
  const glm::dvec3 to(target.x, plan.ground.height(target) + target_height, target.y);
  return {glm::vec3(from), glm::vec3(glm::normalize(to - from)), {0.0f, 1.0f, 0.0f}, kFieldOfView};
}

/// How far the woods reach from `from` along `direction` without a break, in metres.
double woodsAlong(const Site& site, const glm::dvec2& from, const glm::dvec2& direction) {
  double reach = 0.0;
  for (double t = 8.0;; t += 8.0) {
    const glm::dvec2 p = from + direction * t;
    if (std::max(std::abs(p.x), std::abs(p.y)) > site.half()) return reach;
    if (site.urbanity(p) > -0.05 || site.woodland(p) < 0.0) return reach;
    reach += 8.0;
  }
}

struct WoodsView {
  glm::dvec2 position{0.0}, direction{1.0, 0.0}, deep{0.0};
};

/// A place with the longest stretch of woods in front of it, and the place furthest from any border of the woods.
WoodsView findWoods(const CityPlan& plan) {
  constexpr int kDirections = 24;
  const size_t stride =
      1 + plan.blocks.size() / 2'000;  // a large world has more woods than a view needs to be chosen from
  WoodsView view;
  double longest = -1.0, deepest = -1.0;
  for (size_t b = 0; b < plan.blocks.size(); b += stride) {
    const Block& block = plan.blocks[b];
    if (block.use != Use::forest || block.lot.size() < 3) continue;
    const glm::dvec2 middle = centroid(block.lot);
    double nearest_border = 1e300;
    for (int i = 0; i < kDirections; ++i) {
      const glm::dvec2 direction = unitVector(static_cast<double>(i) / kDirections);
      const double reach = woodsAlong(plan.site, middle, direction);
      nearest_border = std::min(nearest_border, reach);
      if (reach <= longest) continue;
      longest = reach;
      view.position = middle;
      view.direction = direction;
    }
    if (nearest_border <= deepest) continue;
    deepest = nearest_border;
    view.deep = middle;
  }
  return view;
}

/// A direction from the town (in turns, x towards z) in which a camera at `distance` has no landmark close in front of
/// it.
double freeDirection(const CityPlan& plan, const Furnishing& furnishing, double distance, double preferred) {
  double best = preferred, best_clearance = -1.0;
  for (int i = -5; i <= 5; ++i) {
    const double turns = preferred + 0.02 * i;
    const glm::dvec2 away = unitVector(turns), position = plan.site.town_centre + away * distance;
    double clearance = 1.2 * distance;  // what is further off is no obstacle
    for (const Stand& landmark : furnishing.landmarks) {
      const glm::dvec2 offset = landmark.position - position;
      const double aside = std::abs(offset.x * away.y - offset.y * away.x);
      clearance = std::min(clearance, glm::length(offset) + 1.5 * aside);
    }
    if (clearance <= best_clearance) continue;
    best_clearance = clearance;
    best = turns;
  }
  return best;
}

/// The sun `aside` turns from the direction `turns` (x towards z), as daylight() counts azimuths.
Environment daylightAt(float elevation_degrees, double turns, double aside) {
  return daylight(elevation_degrees * kDegree, static_cast<float>((0.25 - turns - aside) * 6.283185307179586));
}

}  // namespace

std::vector<NamedCamera> cityCameras(const CityPlan& plan, const Furnishing& furnishing) {
  const Site& site = plan.site;
  const double radius = site.town_radius;
  const glm::dvec2 town = site.town_centre, market = centroid(plan.blocks[plan.market].lot);
  const WoodsView woods = findWoods(plan);
  const glm::dvec2 south(0.0, 1.0);
  const Environment noon = daylightAt(60.0f, 0.32, 0.12), morning = daylightAt(36.0f, -0.15, 0.0);
  std::vector<NamedCamera> cameras;

  const double tilted_distance = 0.88 * radius, over = std::clamp(0.30 * radius, 33.0, 75.0);
  const glm::dvec2 tilted = unitVector(freeDirection(plan, furnishing, tilted_distance, 0.32));
  cameras.push_back({"tilted_city", "Over the roofs towards the horizon",
                     lookAt(plan, town + tilted * tilted_distance, over, town - tilted * (0.35 * radius), 2.0), noon});

  const glm::dvec2 across = market + (market - furnishing.town_view) * 0.25;
  cameras.push_back({"animated_models", "From a balcony at the market square",
                     lookAt(plan, furnishing.town_view, 5.6, across, 3.2), noon});

  const double sunset_distance = 1.02 * radius, edge = std::clamp(0.22 * radius, 27.0, 80.0);
  const double sunset_turns = freeDirection(plan, furnishing, sunset_distance, 0.20);
  cameras.push_back({"city_at_sunset", "The town from its edge, the sun low at the side",
                     lookAt(plan, town + unitVector(sunset_turns) * sunset_distance, edge, town, 4.0),
                     daylightAt(4.0f, sunset_turns, 0.19)});

  cameras.push_back({"high_above", "The whole town from far above",
                     lookAt(plan, town + south * (1.15 * radius), 1.9 * radius, town + south * (0.08 * radius), 0.0),
                     noon});

  const double above = std::clamp(0.16 * site.half(), 38.0, 70.0);
  cameras.push_back({"forest", "Treetops from above",
                     lookAt(plan, woods.deep - woods.direction * (0.42 * above), above,
                            woods.deep + woods.direction * (0.1 * above), 4.0),
                     morning});

  const double crest = 29.0;  // metres: above the tallest tree
  cameras.push_back({"tilted_forest", "Over the treetops towards the horizon",
                     lookAt(plan, woods.position, crest, woods.position + woods.direction * 100.0, crest - 11.0),
                     morning});
  return cameras;
}

}  // namespace helio::scene
