// Passes `svgf_temporal`, `svgf_variance` and `svgf_atrous`: spatiotemporal variance-guided filtering [Schied et al.
// 2017], over diffuse and specular light apart.
#pragma once

#include <vector>

#include "gpu/pipelines.h"
#include "render/passes/denoiser.h"

namespace helio::render {

/// What the next tick goes on from.
enum class Feedback {
  filtered,    ///< what the first iteration of the filter makes, as published
  integrated,  ///< the mean over ticks alone: nothing that was filtered. The mean heeds gradients [Schied et al. 2018]
};

class Svgf : public DenoiserPasses {
 public:
  explicit Svgf(gpu::Device& device, Feedback feedback = Feedback::filtered);
  void add(const ViewPass& pass, const shared::SampleConstants& sample,
           const shared::SampleConstants& last) const override;

 private:
  Feedback feedback_;
  gpu::ComputePipeline temporal_, variance_;
  std::vector<gpu::ComputePipeline> atrous_;  // by iteration; the last one makes the picture
};

}  // namespace helio::render
