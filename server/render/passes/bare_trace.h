// Pass `bare_trace`: the rays of `log_rays` through shaders that do nothing. What tracing alone costs.
#pragma once

#include "gpu/pipelines.h"
#include "render/passes/pass.h"

namespace helio::render {

class BareTrace {
 public:
  explicit BareTrace(gpu::Device& device);
  void add(const ViewPass& pass, const shared::SampleConstants& sample) const;

 private:
  gpu::RayTracingPipeline pipeline_;
};

}  // namespace helio::render
