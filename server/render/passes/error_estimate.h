// Pass `error_estimate`: sums up over the picture how noisy a denoiser says its light is.
#pragma once

#include "gpu/pipelines.h"
#include "render/passes/pass.h"

namespace helio::render {

/// The settings' denoiser leaves each pixel's relative variance, variance / (radiance^2 + 0.01) as mean over channels,
/// in the fourth channel of the image `radiance`.
inline bool knowsVariance(const ViewSettings& settings) {
  return (settings.denoiser == Denoiser::svgf || settings.denoiser == Denoiser::asvgf) &&
         settings.inspect == Inspect::nothing;
}

class ErrorEstimate {
 public:
  explicit ErrorEstimate(gpu::Device& device) : pipeline_(device, "error_estimate/error_estimate.comp") {}
  /// Right behind the denoiser.
  void add(const ViewPass& pass, const shared::SampleConstants& last) const;
  /// The mean over the picture's pixels, of what was read back.
  static double variance(const shared::ViewState& state, uint64_t pixels);

 private:
  gpu::ComputePipeline pipeline_;
};

}  // namespace helio::render
