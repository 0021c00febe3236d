// Passes `reblur_preblur`, `reblur_temporal`, `reblur_history_fix`, `reblur_blur` and `reblur_stabilise`: a
// hierarchical recurrent denoiser [Zhdan 2021, ReBLUR, Ray Tracing Gems II, chapter 49]. What was blurred is kept, and
// blurred again in every tick with a radius that shrinks as samples gather.
#pragma once

#include "gpu/pipelines.h"
#include "render/passes/denoiser.h"

namespace helio::render {

class Reblur : public DenoiserPasses {
 public:
  explicit Reblur(gpu::Device& device);
  void add(const ViewPass& pass, const shared::SampleConstants& sample,
           const shared::SampleConstants& last) const override;

 private:
  gpu::ComputePipeline preblur_, temporal_, mip_, fix_, blur_, postblur_, stabilise_;
};

}  // namespace helio::render
