// What moves in the city, and along which ways.
#pragma once

#include <vector>

#include "scene/city_furnish.h"

namespace helio::scene {

struct Units {
  std::vector<Route> routes;
  std::vector<Placement> placements;
};

/// `count` walkers and vehicles on closed ways: walkers around built-up blocks on the pavement, in two lanes of
/// opposite directions, vehicles around them on the right half of the streets; nearer to the market square there are
/// more.
Units placeUnits(const CityPlan& plan, const Catalogue& catalogue, size_t count);

}  // namespace helio::scene
