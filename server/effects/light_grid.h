// Which emissive instances matter where: the ground plane in cells, each with its few most important lights.
// Shaders sample mostly these and sometimes any light of the world (shaders/lib/lights.glsl), which keeps the estimate
// unbiased; without the lists a city of a thousand lamps lights each doorstep once in a thousand samples.
#pragma once

#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "shared/scene.h"

namespace helio::effects {

inline constexpr float kLightCell = 16.0f;    ///< metres: a hitbox's edge
inline constexpr float kLightRadius = 72.0f;  ///< metres around a cell's centre within which lights are listed

struct PlacedLight {
  uint32_t slot;
  glm::vec3 centre;
  float weight;          ///< power, > 0
  bool distant = false;  ///< shines alike everywhere, `weight` is power over squared distance there; `centre` is unused
};

struct LightGrid {
  glm::vec2 origin{0.0f};  ///< x and z of the first cell's corner, metres
  glm::uvec2 size{0u};     ///< cells
  float cells_per_metre = 0.0f;
  std::vector<shared::LightCell> cells;  ///< row by row of z
};

/// Without lights in places there is no grid. Cells grow beyond 16 m where the lights are so far apart that there would
/// be more than a million.
LightGrid makeLightGrid(std::span<const PlacedLight> lights);

}  // namespace helio::effects
