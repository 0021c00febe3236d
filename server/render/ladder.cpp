#include "render/ladder.h"

#include <algorithm>
#include <iterator>

namespace helio::render {
namespace {

/// The passes that a sample more, or a bounce more, makes longer.
constexpr const char* kScalingPasses[] = {"primary_traced", "path_trace", "statistics", "accumulate"};

// From `helio-bench accuracy --size 1920x1080 --axis preset --runs 2 --reference-spp 192` (H200, driver 580.159.04,
// 2026-11-23, the city by day, without TAA): biases, variances, and times of the passes above. (That of `sketch` is
// from the same command with `--set taa=1`: as the first setting of this run it met a slow clock.) With TAA biases are
// a quarter of these at rest, but about these in a quick flight, so it has no list of its own. Of its variance SVGF
// knows 0.72 (tests/denoise/error_estimate_test.cpp, lamp room and sunlit patch).
constexpr double kKnown = 0.72;
constexpr Price price(double scaling_ms, double variance, double bias) {
  return {scaling_ms, variance, kKnown * variance, bias};
}
const PriceList kUsual{"H200, 2026-11-23, the city by day, 1920 x 1080, at rest",
                       {{price(4.65, 0.00049, 0.0576), price(6.35, 0.0008, 0.0418), price(7.29, 0.00119, 0.042),
                         price(14.6, 0.00055, 0.0421), price(29.6, 0.00033, 0.0422), price(59.6, 0.00017, 0.0423)}}};

}  // namespace

ViewSettings onRung(const ViewSettings& wanted, size_t rung) {
  ViewSettings settings = wanted;
  settings.bounces = kLadder[rung].bounces;
  settings.samples = kLadder[rung].samples;
  if (settings.samples > 1) settings.extra_samples = 0.0f;  // each pixel has more than one as it is
  if (settings.denoiser == Denoiser::none) settings.denoiser = Denoiser::svgf;
  return settings;
}

double scalingMs(const FrameStats& stats) {
  double sum = 0.0;
  for (const PassTime& pass : stats.passes)
    if (std::find(std::begin(kScalingPasses), std::end(kScalingPasses), pass.name) != std::end(kScalingPasses))
      sum += pass.ms;
  return sum;
}

const PriceList& usualPrices() { return kUsual; }

size_t nearestRung(const ViewSettings& settings) {
  size_t nearest = 0;
  for (size_t rung = 0; rung < kRungs; ++rung)
    if (kLadder[rung].bounces <= settings.bounces && kLadder[rung].samples <= settings.samples) nearest = rung;
  return nearest;
}

std::optional<ErrorBelief> believe(const PriceList& prices, const ViewSettings& settings, const FrameStats& stats) {
  if (!stats.variance) return std::nullopt;
  const size_t rung = nearestRung(settings);
  return ErrorBelief{prices.variance(rung, *stats.variance), prices.rungs[rung].bias};
}

}  // namespace helio::render
