// The city generator: a deterministic function of its parameters.
#pragma once

#include <cstdint>

#include "base/result.h"
#include "scene/scene.h"

namespace helio::scene {

struct CityParameters {
  uint64_t seed = 1;
  uint32_t instances = 10'000;  ///< static instances wanted, [1'000, 1'000'000]; the world's side grows with it
  uint32_t animated = 0;        ///< moving units beside them, [0, 10'000]: walkers, vehicles, mills, fitted houses
};

/// Light of a sun at `elevation` and `azimuth` (radians, azimuth from +z towards +x) with the sky that goes with it.
/// Noon is about 60 degrees of elevation, sunset about 4.
Environment daylight(float elevation, float azimuth);

/// Builds the city. Same parameters, same bytes. Errors: `instances` out of range (invalid).
Result<ScenePtr> generateCity(const CityParameters& parameters);

}  // namespace helio::scene
