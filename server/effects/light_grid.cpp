#include "effects/light_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace helio::effects {
namespace {

constexpr float kMaxCells = 1'000'000.0f;

/// Keeps the heaviest kLightsPerCell entries in `cell`; `cdf` holds plain weights until finish().
void insert(shared::LightCell& cell, uint32_t slot, float weight) {
  uint32_t place = cell.count;
  if (cell.count == shared::kLightsPerCell) {
    place = static_cast<uint32_t>(std::min_element(cell.cdf, cell.cdf + cell.count) - cell.cdf);
    if (cell.cdf[place] >= weight) return;
  } else {
    ++cell.count;
  }
  cell.slots[place] = slot;
  cell.cdf[place] = weight;
}

void finish(shared::LightCell& cell) {
  double sum = 0.0, below = 0.0;
  for (uint32_t i = 0; i < cell.count; ++i) sum += cell.cdf[i];
  cell.found = cell.count;
  cell.irradiance = static_cast<float>(sum);
  for (uint32_t i = 0; i < cell.count; ++i) {
    below += cell.cdf[i];
    cell.cdf[i] = i + 1 == cell.count ? 1.0f : static_cast<float>(below / sum);
  }
}

}  // namespace

LightGrid makeLightGrid(std::span<const PlacedLight> lights) {
  LightGrid grid;
  glm::vec2 low(std::numeric_limits<float>::infinity()), high = -low;
  for (const PlacedLight& light : lights) {
    if (light.distant) continue;
    const glm::vec2 p(light.centre.x, light.centre.z);
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  if (!(low.x <= high.x)) return grid;
  low -= kLightRadius;
  high += kLightRadius;
  const glm::vec2 extent = high - low;
  const float cell = std::max(kLightCell, std::sqrt(extent.x * extent.y / kMaxCells));
  grid.origin = low;
  grid.cells_per_metre = 1.0f / cell;
  grid.size = glm::uvec2(glm::ceil(extent / cell));
  grid.cells.resize(size_t{grid.size.x} * grid.size.y);

  // Enter each light in the cells around it. Inside of a cell's own half diagonal distance says nothing.
  const float nearest = 0.7f * cell;
  for (const PlacedLight& light : lights) {
    if (light.distant) {
      for (shared::LightCell& lit : grid.cells) insert(lit, light.slot, light.weight);
      continue;
    }
    const glm::vec2 p = (glm::vec2(light.centre.x, light.centre.z) - low) / cell;
    const float reach = kLightRadius / cell;
    const auto first = glm::uvec2(glm::max(glm::floor(p - reach), glm::vec2(0.0f)));
    const auto last = glm::min(glm::uvec2(p + reach), grid.size - 1u);
    for (uint32_t z = first.y; z <= last.y; ++z)
      for (uint32_t x = first.x; x <= last.x; ++x) {
        const float distance = cell * glm::distance(p, glm::vec2(x, z) + 0.5f);
        if (distance > kLightRadius) continue;
        insert(grid.cells[size_t{z} * grid.size.x + x], light.slot,
               light.weight / std::pow(std::max(distance, nearest), 2.0f));
      }
  }
  for (shared::LightCell& c : grid.cells) finish(c);
  return grid;
}

}  // namespace helio::effects
