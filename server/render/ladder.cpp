#include "render/ladder.h"

#include <algorithm>
#include <iterator>

namespace helio::render {
namespace {

/// The passes that a sample more, or a bounce more, makes longer.
constexpr const char* kScalingPasses[] = {"primary_traced", "path_trace", "statistics", "accumulate"};

// Of lavapipe: helio-bench accuracy --axis preset --size 160x90 --instances 1000 --camera tilted_city --motion fly
// --frames 16 --runs 4 --reference-spp 512, 2026-11-22.
const PriceList kSoftware{"lavapipe, 2026-11-22: the city by day, 160 x 90, in flight",
                          {{{60.0, 0.010, 0.010, 0.110},
                            {80.0, 0.010, 0.010, 0.100},
                            {90.0, 0.010, 0.010, 0.095},
                            {180.0, 0.006, 0.006, 0.090},
                            {400.0, 0.004, 0.004, 0.085},
                            {900.0, 0.002, 0.002, 0.080}}}};

}  // namespace

ViewSettings onRung(const ViewSettings& wanted, size_t rung) {
  ViewSettings settings = wanted;
  settings.bounces = kLadder[rung].bounces;
  settings.samples = kLadder[rung].samples;
  if (settings.denoiser == Denoiser::none) settings.denoiser = Denoiser::svgf;
  settings.taa = true;
  return settings;
}

double scalingMs(const FrameStats& stats) {
  double sum = 0.0;
  for (const PassTime& pass : stats.passes)
    if (std::find(std::begin(kScalingPasses), std::end(kScalingPasses), pass.name) != std::end(kScalingPasses))
      sum += pass.ms;
  return sum;
}

const PriceList& priceListFor(const DeviceInfo& device) {
  (void)device;
  return kSoftware;
}

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
