#include "render/ladder.h"

#include <algorithm>
#include <iterator>

namespace helio::render {
namespace {

/// The passes that a sample more, or a bounce more, makes longer.
constexpr const char* kScalingPasses[] = {"primary_traced", "path_trace", "statistics", "accumulate"};

// From tests/bench/README.md, "accuracy" (H200, driver 580.159.04, 2026-11-22, the city by day at 1080p): times are
// what a sample adds to a frame (5.28 ms at three bounces), less what fewer bounces save; 0 and 1 bounces have been
// measured, 5 too, 8 taken for little more. Variance is SVGF's at three bounces times the ratio of raw frames'
// variances, bias SVGF's and what no bounce adds to a raw frame's. Of its variance SVGF knows 0.72
// (tests/denoise/error_estimate_test.cpp, lamp room and sunlit patch).
constexpr double kKnown = 0.72;
constexpr Price price(double scaling_ms, double variance, double bias) {
  return {scaling_ms, variance, kKnown * variance, bias};
}
const PriceList kUsual{"H200, 2026-11-22, the city by day, 1920 x 1080, at rest",
                       {{price(3.79, 0.00036, 0.114), price(4.81, 0.00086, 0.104), price(5.28, 0.0018, 0.104),
                         price(10.56, 0.00112, 0.104), price(21.4, 0.00108, 0.104), price(43.2, 0.00036, 0.104)}}};

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
