#include "scene/city_cameras.h"

#include <algorithm>
#include <cmath>

#include "scene/random.h"

namespace helio::scene {
namespace {

constexpr float kDegree = 0.017453292f;
constexpr float kFieldOfView = 50.0f * kDegree;

/// Looks from `position`, `height` metres above its ground, at a point `target_height` metres above that of `target`.
Camera lookAt(const CityPlan& plan, const glm::dvec2& position, double height, const glm::dvec2& target, double target_height) {
  const glm::dvec3 from(position.x, plan.ground.height(position) + height, position.y);
  const glm::dvec3 to(target.x, plan.ground.height(target) + target_height, target.y);
  return {glm::vec3(from), glm::vec3(glm::normalize(to - from)), {0.0f, 1.0f, 0.0f}, kFieldOfView};
}

/// How far the woods reach from `from` along `direction`, in metres.
double woodsAlong(const Site& site, const glm::dvec2& from, const glm::dvec2& direction) {
  double reach = 0.0;
  for (double t = 8.0;; t += 8.0) {
    const glm::dvec2 p = from + direction * t;
    if (std::max(std::abs(p.x), std::abs(p.y)) > site.half()) return reach;
    reach += site.urbanity(p) < 0.0 && site.woodland(p) > 0.0 ? 8.0 : 0.0;
  }
}

struct WoodsView {
  glm::dvec2 position{0.0}, direction{1.0, 0.0}, deep{0.0};
};

/// A place at the woods' border with the deepest woods in front of it, and the place furthest from any border.
WoodsView findWoods(const CityPlan& plan) {
  WoodsView view;
  double longest = -1.0, deepest = -1e300;
  for (const Block& block : plan.blocks) {
    if (block.use != Use::forest || block.lot.size() < 3) continue;
    const glm::dvec2 middle = centroid(block.lot);
    const double margin = std::min(plan.site.half() - std::max(std::abs(middle.x), std::abs(middle.y)), 0.12 * plan.site.side);
    const double depth = plan.site.woodland(middle) + 4.0 * margin / plan.site.side;
    if (depth > deepest) {
      deepest = depth;
      view.deep = middle;
    }
    for (int i = 0; i < 24; ++i) {
      const glm::dvec2 direction = unitVector(i / 24.0);
      const double reach = woodsAlong(plan.site, middle, direction);
      if (reach <= longest) continue;
      longest = reach;
      view.position = middle;
      view.direction = direction;
    }
  }
  return view;
}

}  // namespace

std::vector<NamedCamera> cityCameras(const CityPlan& plan, const Furnishing& furnishing) {
  const Site& site = plan.site;
  const double radius = site.town_radius;
  const glm::dvec2 town = site.town_centre, market = centroid(plan.blocks[plan.market].lot);
  const Environment noon = daylight(60.0f * kDegree, 0.70f), sunset = daylight(4.0f * kDegree, -1.15f);
  const Environment morning = daylight(38.0f * kDegree, 2.2f);
  const WoodsView woods = findWoods(plan);
  const glm::dvec2 south(0.0, 1.0), south_west(-0.42, 0.9075);

  std::vector<NamedCamera> cameras;
  const double over = std::clamp(0.30 * radius, 30.0, 75.0);
  cameras.push_back({"tilted_city", "Over the roofs towards the horizon",
                     lookAt(plan, town + south_west * (0.80 * radius), over, town - south_west * (0.35 * radius), 2.0), noon});
  const glm::dvec2 across = market + (market - furnishing.town_view) * 0.25;
  cameras.push_back({"animated_models", "From a balcony at the market square",
                     lookAt(plan, furnishing.town_view, 5.6, across, 3.2), noon});
  cameras.push_back({"city_at_sunset", "The town from its edge, the sun low at the side",
                     lookAt(plan, town + glm::dvec2(-0.10, 0.995) * (1.05 * radius), std::clamp(0.24 * radius, 24.0, 80.0), town, 4.0), sunset});
  cameras.push_back({"high_above", "The whole town from far above",
                     lookAt(plan, town + south * (1.15 * radius), 1.9 * radius, town + south * (0.08 * radius), 0.0), noon});
  const double above = std::clamp(0.20 * site.half(), 42.0, 90.0);
  cameras.push_back({"forest", "Treetops from above",
                     lookAt(plan, woods.deep - woods.direction * (0.42 * above), above, woods.deep + woods.direction * (0.1 * above), 4.0), morning});
  const double crest = 27.0;
  cameras.push_back({"tilted_forest", "Over the treetops towards the horizon",
                     lookAt(plan, woods.position, crest, woods.position + woods.direction * 100.0, crest - 9.0), morning});
  return cameras;
}

}  // namespace helio::scene
