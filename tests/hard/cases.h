// Numerically hard scenes of a few lines, each with what must hold: the table of tests/hard/README.md as code.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace helio::test {

struct Before {
  scene::Camera camera;
  uint32_t size = 32;
};
struct Twin {
  scene::ScenePtr scene;
  scene::Camera camera;
};

/// One picture of a case. Unless it has a twin, all of it shows the same thing, so its mean is what is compared.
struct HardScene {
  scene::ScenePtr scene;
  scene::Camera camera;
  uint32_t bounces = 3;
  uint32_t samples = 16;        ///< a pixel of 32 x 32
  std::optional<double> truth;  ///< mean radiance
  double tolerance = 0.01;      ///< relative
  double bound = 1.02;          ///< of the mean, in units of the truth or of radiance 1
  /// Samples after which the mean must be within kConverged of the truth; 0: those above are enough.
  uint32_t converged_samples = 0;
  uint32_t size = 32;  ///< pixels, both ways; a multiple of 8
  /// What the same view showed before: it must leave no trace.
  std::vector<Before> before = {};
  /// The same thing at another place: the picture must look the same.
  std::shared_ptr<const Twin> twin = nullptr;
  double tick_seconds = 1.0 / 60.0;  ///< of world time
};

/// Where a truth is known: relative error of the converged mean.
inline constexpr double kConverged = 0.01;
/// Structural similarity of twins.
inline constexpr double kAlike = 0.99;

struct HardCase {
  std::string name;
  std::string parameter;       ///< what grows harder, with its unit
  std::vector<double> values;  ///< 1 x, 10 x, 100 x, 1000 x as hard (about), or variants
  std::function<HardScene(double)> make;
  bool variants = false;  ///< the values are kinds, none harder than the other
};

const std::vector<HardCase>& hardCases();

}  // namespace helio::test
