// Renders a hard scene and says what does not hold.
#pragma once

#include <array>

#include "hard/cases.h"
#include "render/renderer.h"

namespace helio::test {

/// A way to the same picture.
struct Way {
  const char* name;
  render::Mode mode;
  render::Primary primary;
};
inline constexpr std::array<Way, 3> kWays{{{"reference", render::Mode::reference, render::Primary::traced},
                                           {"hybrid, traced", render::Mode::hybrid, render::Primary::traced},
                                           {"hybrid, raster", render::Mode::hybrid, render::Primary::raster}}};

/// All of the red channel: scenes with a truth are grey.
struct Measured {
  render::Frame frame;
  uint32_t samples = 0;        ///< a pixel
  uint64_t nonfinite = 0;      ///< samples that were dropped, of all ticks
  uint32_t broken_texels = 0;  ///< not finite, or negative
  double mean = 0.0;
  double standard_error = 0.0;       ///< of the mean
  double energy_error = 0.0;         ///< part by which the mean exceeds the truth, or radiance 1; 0 where it does not
  std::optional<double> error;       ///< |mean - truth| / truth; absolute where the truth is 0
  double worst_texel = 0.0;          ///< farthest from the truth, in units of it; without one: the brightest
  std::optional<double> similarity;  ///< to the twin's picture
};

/// `converged`: with as many samples as it takes to be within kConverged. Errors: the renderer's.
Result<Measured> measure(render::Renderer& renderer, const HardScene& scene, const Way& way, bool converged);

/// One line a property that does not hold; empty: all do.
std::vector<std::string> broken(const HardScene& scene, const Measured& measured, bool converged);

}  // namespace helio::test
