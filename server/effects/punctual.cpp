#include "effects/punctual.h"

#include <algorithm>
#include <cmath>

namespace helio::effects {
namespace {

/// A small convex lamp of area times radiance W has an intensity of W / 4 to each side.
constexpr float kWeightOfIntensity = 4.0f;

float luminanceOf(const scene::PunctualLight& light) {
  return light.intensity * glm::dot(light.color, glm::vec3(0.2126f, 0.7152f, 0.0722f));
}

}  // namespace

std::vector<shared::PunctualRecord> punctualRecords(std::span<const scene::PunctualLight> lights) {
  using Type = scene::PunctualLight::Type;
  std::vector<shared::PunctualRecord> records;
  for (const scene::PunctualLight& light : lights) {
    shared::PunctualRecord record{};
    record.position = light.type == Type::directional ? -light.direction : light.position;
    record.direction = light.direction;
    record.type = light.type == Type::directional ? shared::kLightDirectional
                  : light.type == Type::spot      ? shared::kLightSpot
                                                  : shared::kLightPoint;
    record.inverse_range = std::isfinite(light.range) ? 1.0f / light.range : 0.0f;
    record.intensity = light.color * light.intensity;
    record.weight = kWeightOfIntensity * luminanceOf(light);
    // From afar a distant light counts as if it stood at the light grid's radius.
    if (light.type == Type::directional) record.weight *= kLightRadius * kLightRadius;
    const float outer = std::cos(light.outer_cone);
    record.cone_scale = 1.0f / std::max(0.001f, std::cos(light.inner_cone) - outer);
    record.cone_offset = -outer * record.cone_scale;
    records.push_back(record);
  }
  return records;
}

std::vector<PlacedLight> placedLights(std::span<const scene::PunctualLight> lights) {
  std::vector<PlacedLight> placed;
  for (uint32_t i = 0; i < lights.size(); ++i) {
    const float weight = kWeightOfIntensity * luminanceOf(lights[i]);
    if (weight > 0.0f)
      placed.push_back({shared::kPunctualLight | i, lights[i].position, weight,
                        lights[i].type == scene::PunctualLight::Type::directional});
  }
  return placed;
}

}  // namespace helio::effects
