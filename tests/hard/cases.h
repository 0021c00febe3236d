// Numerically hard scenes of a few lines, each with what must hold: the table of tests/hard/README.md as code.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace helio::test {

/// One picture of a case. All of it shows the same thing, so its mean is what is compared.
struct HardScene {
  scene::ScenePtr scene;
  scene::Camera camera;
  uint32_t bounces = 3;
  uint32_t samples = 16;        ///< a pixel of 32 x 32
  std::optional<double> truth;  ///< mean radiance
  double tolerance = 0.01;      ///< relative
  double bound = 1.02;          ///< of the mean, in units of the truth or of radiance 1
};

struct HardCase {
  std::string name;
  std::string parameter;       ///< what grows harder, with its unit
  std::vector<double> values;  ///< from 1 x to 1000 x as hard, or variants
  std::function<HardScene(double)> make;
};

const std::vector<HardCase>& hardCases();

}  // namespace helio::test
