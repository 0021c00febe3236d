// The ladder of presets that the controller climbs, and what each rung costs and brings.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>

#include "render/renderer.h"

namespace helio::render {

/// What a goal decides; everything else is the viewer's.
struct Preset {
  const char* name;
  uint32_t bounces;
  uint32_t samples;  ///< paths a pixel a tick
};

/// The quickest first.
inline constexpr std::array<Preset, 6> kLadder{{
    {"sketch", 0, 1},
    {"fast", 1, 1},
    {"balanced", 3, 1},
    {"rich", 3, 2},
    {"fine", 5, 4},
    {"finest", 8, 8},
}};
inline constexpr size_t kRungs = kLadder.size();

/// A rung's settings for a viewer who asked for `wanted`: with a denoiser, SVGF unless another was chosen.
ViewSettings onRung(const ViewSettings& wanted, size_t rung);

/// Milliseconds of the passes whose time grows with the rung, of a frame; the others are the world's, or cost the same
/// on all.
double scalingMs(const FrameStats& stats);

/// What a rung costs and what is wrong with its pictures, as `helio-bench accuracy --axis preset` measures it.
struct Price {
  double scaling_ms = 0.0;  ///< of scalingMs(), > 0
  double variance = 0.0;    ///< relative mean square error from noise, > 0
  double estimated = 0.0;   ///< the same, as the denoiser believed, > 0
  double bias = 0.0;        ///< relative mean square error that all random numbers share
};

/// Only ratios of times and of variances count, so one scene's list serves others of its kind.
struct PriceList {
  std::string source;  ///< the command, the device and the day, for people
  std::array<Price, kRungs> rungs;

  /// What the denoiser believes, made comparable by what it was found to be on that rung.
  double variance(size_t rung, double estimated) const {
    return estimated * rungs[rung].variance / rungs[rung].estimated;
  }
};

/// The list that comes with the program.
const PriceList& usualPrices();

/// The rung whose prices say most about these settings: of those that have no more bounces, the last that has no more
/// samples.
size_t nearestRung(const ViewSettings& settings);

/// What is known of a picture's relative mean square error.
struct ErrorBelief {
  double variance = 0.0;
  double bias = 0.0;
};
/// Nothing: the picture's denoiser knows no variance.
std::optional<ErrorBelief> believe(const PriceList& prices, const ViewSettings& settings, const FrameStats& stats);

}  // namespace helio::render
