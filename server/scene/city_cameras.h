// The six views of the city (after Kelling, fig. 4.6).
#pragma once

#include <vector>

#include "scene/city_furnish.h"

namespace helio::scene {

std::vector<NamedCamera> cityCameras(const CityPlan& plan, const Furnishing& furnishing);

}  // namespace helio::scene
