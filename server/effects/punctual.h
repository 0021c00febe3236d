// Lights without extent as light sampling knows them.
#pragma once

#include <span>
#include <vector>

#include "effects/light_grid.h"
#include "scene/scene.h"
#include "shared/scene.h"

namespace helio::effects {

/// The records of a scene's punctual lights, in its order [KHR_lights_punctual]. `weight` is what chooses among all
/// lamps of the world: that of a small convex lamp which sends as much light to all sides.
std::vector<shared::PunctualRecord> punctualRecords(std::span<const scene::PunctualLight> lights);

/// The same as lights of the light grid; their slots are kPunctualLight and the index.
std::vector<PlacedLight> placedLights(std::span<const scene::PunctualLight> lights);

}  // namespace helio::effects
