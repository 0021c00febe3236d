#include "render/ladder.h"

#include <algorithm>
#include <iterator>

namespace helio::render {
namespace {

/// The passes that a sample more, or a bounce more, makes longer.
constexpr const char* kScalingPasses[] = {"primary_traced", "path_trace", "statistics", "accumulate"};

// From tests/bench/README.md, "accuracy --axis preset" (H200, driver 580.159.04, 2026-11-23, the city by day at 1080p,
// four runs). Of `rich` and `fine` the variance lies between their neighbours': one bright path in one run made theirs
// 0.275 and 0.05, and the denoiser cuts such paths since. Of its variance SVGF knows 0.72
// (tests/denoise/error_estimate_test.cpp, lamp room and sunlit patch).
constexpr double kKnown = 0.72;
constexpr Price price(double scaling_ms, double variance, double bias) {
  return {scaling_ms, variance, kKnown * variance, bias};
}
const PriceList kUsual{"H200, 2026-11-23, the city by day, 1920 x 1080, at rest",
                       {{price(4.57, 0.00037, 0.061), price(6.68, 0.0007, 0.0453), price(7.86, 0.00119, 0.0455),
                         price(16.3, 0.0011, 0.0321), price(33.6, 0.0009, 0.0324), price(67.9, 0.00072, 0.0324)}}};

}  // namespace

ViewSettings onRung(const ViewSettings& wanted, size_t rung) {
  ViewSettings settings = wanted;
  settings.bounces = kLadder[rung].bounces;
  settings.samples = kLadder[rung].samples;
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
