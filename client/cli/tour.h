// Scripted tours: what a viewer does, step by step. README.md documents the format.
#pragma once

#include <string>
#include <variant>
#include <vector>

#include <glm/vec2.hpp>

#include "cli/command.h"

namespace helio::cli {

/// In front of the camera, or somewhere: metres.
struct Place {
  std::optional<float> ahead;
  glm::vec2 at{0.0f};  ///< x, z
};

struct Jump {
  std::string camera;
};
struct Fly {
  std::string from, to;
};  ///< "here": where the viewer is
struct BuildStep {
  std::string prefab;
  uint32_t count = 1;
  Place place;
};
struct DestroyStep {
  Place place;
  float radius = 0;
};
struct SunStep {
  double elevation = 0, azimuth = 0;
};  ///< degrees

struct Step {
  std::variant<Jump, Fly, BuildStep, DestroyStep, SunStep> what;
  double seconds = 2;
};

struct Tour {
  std::vector<Step> steps;

  double seconds() const;
  /// Scales every step so that the tour lasts so long.
  void last(double seconds);
};

/// Errors (invalid): what is wrong, in which step.
Result<Tour> parseTour(const std::string& text);

/// Flies, jumps twice, builds and destroys, with whatever cameras and prefabs the world has.
Tour usualTour(const v1::World& world, const std::vector<v1::Prefab>& prefabs);

}  // namespace helio::cli
