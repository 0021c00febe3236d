// Passes `svgf_temporal`, `svgf_variance` and `svgf_atrous`: spatiotemporal variance-guided filtering [Schied et al.
// 2017], over diffuse and specular light apart. What the first iteration of the filter makes is what the next tick goes
// on from, as published.
#pragma once

#include <array>

#include "gpu/pipelines.h"
#include "render/passes/denoiser.h"

namespace helio::render {

class Svgf : public DenoiserPasses {
 public:
  explicit Svgf(gpu::Device& device);
  void add(const ViewPass& pass, const shared::SampleConstants& last) const override;

 private:
  gpu::ComputePipeline temporal_, variance_;
  std::array<gpu::ComputePipeline, 2> atrous_;  // an iteration; the last one, which makes the picture
};

}  // namespace helio::render
