// Pass `occlusion`: ambient occlusion, filtered by itself, joins what no denoiser filters.
#pragma once

#include "gpu/pipelines.h"
#include "render/passes/pass.h"

namespace helio::render {

class Occlusion {
 public:
  explicit Occlusion(gpu::Device& device)
      : temporal_(device, "occlusion/temporal.comp"), spatial_(device, "occlusion/spatial.comp") {}
  void add(const ViewPass& pass, const shared::SampleConstants& sample) const;

 private:
  gpu::ComputePipeline temporal_, spatial_;
};

}  // namespace helio::render
