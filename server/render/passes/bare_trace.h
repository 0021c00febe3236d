// Pass `bare_trace`: the rays of `log_rays` through shaders that do no more than ask alpha masks. What tracing alone
// costs.
#pragma once

#include <array>

#include "gpu/pipelines.h"
#include "render/passes/pass.h"

namespace helio::render {

class BareTrace {
 public:
  explicit BareTrace(gpu::Device& device);
  void add(const ViewPass& pass, const shared::SampleConstants& sample, effects::EffectSet effects) const;

 private:
  std::array<gpu::RayTracingPipeline, 2> pipelines_;  // without and with alpha masks
};

}  // namespace helio::render
