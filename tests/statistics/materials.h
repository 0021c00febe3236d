// Materials and view directions that the tests of the BSDF go through, and how to ask the shaders about them.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "probe.h"

namespace helio::test {

struct Material {
  std::string name;
  glm::vec3 base{0.8f};
  float metallic = 0.0f;
  float roughness = 1.0f;
  bool lambert = false;

  float alpha() const { return roughness * roughness; }
};

inline Material lambertOf(float albedo) { return {"Lambert", glm::vec3(albedo), 0.0f, 1.0f, true}; }
inline Material metalOf(float roughness, const glm::vec3& color = glm::vec3(1.0f)) {
  return {"metal " + std::to_string(roughness), color, 1.0f, roughness, false};
}
inline Material dielectricOf(float roughness) {
  return {"dielectric " + std::to_string(roughness), {0.8f, 0.5f, 0.2f}, 0.0f, roughness, false};
}
inline Material mixedOf(float roughness) {
  return {"half metal " + std::to_string(roughness), {0.9f, 0.6f, 0.3f}, 0.5f, roughness, false};
}

/// In the shading frame, `degrees` off the normal; turned about it, so that no axis is special.
inline glm::vec3 viewAt(double degrees) {
  const double theta = degrees * 3.14159265358979323846 / 180.0, phi = 0.7;
  return glm::vec3(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta));
}

inline shared::ProbeConstants constantsOf(const Material& material) {
  shared::ProbeConstants constants{};
  constants.routine = shared::kSampleBsdf;
  constants.base = material.base;
  constants.metallic = material.metallic;
  constants.roughness = material.roughness;
  constants.lambert = material.lambert;
  return constants;
}

/// kSamples directions drawn from one view.
inline std::vector<shared::DirectionDrawn> drawFrom(const shared::ProbeConstants& constants, const glm::vec3& wo) {
  const std::vector<shared::DirectionQuestion> questions(kSamples, {wo, glm::vec3(0.0f)});
  return probe().ask<shared::DirectionDrawn, shared::DirectionQuestion>("sample_direction.comp", constants, questions);
}

inline std::vector<shared::DirectionDensity> densityOf(const shared::ProbeConstants& constants,
                                                       const std::vector<shared::DirectionQuestion>& questions) {
  return probe().ask<shared::DirectionDensity, shared::DirectionQuestion>("direction_density.comp", constants,
                                                                          questions);
}

}  // namespace helio::test
