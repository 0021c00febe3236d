// Puts houses, trees and everything else on the plan.
#pragma once

#include <vector>

#include "scene/city_plan.h"

namespace helio::scene {

/// Where something stands: `front` is the unit direction (x, z) that its +z looks along.
struct Stand {
  uint32_t prefab = 0;
  glm::dvec2 position{0.0};
  double y = 0.0;
  glm::dvec2 front{0.0, 1.0};
  float scale = 1.0f;

  glm::mat4x3 transform() const;
};

/// What a stand's bounds cover of the ground.
Rectangle footprint(const Stand& stand, const Aabb& bounds);

struct Furnishing {
  std::vector<Stand> stands;
  glm::dvec2 town_view{0.0};     ///< a free corner of the market square, for a camera
  std::vector<Stand> landmarks;  ///< those around the square
  std::vector<Stand> animated;   ///< turning mills and fitted houses: beside the stands
};

/// Exactly `count` stands: town first, then trees in the woods until the number is met. Up to `mills` turning mills in
/// fields, and up to `fitted` farm houses that follow the ground, come on top.
Furnishing furnish(const CityPlan& plan, const Catalogue& catalogue, size_t count, size_t mills, size_t fitted);

}  // namespace helio::scene
