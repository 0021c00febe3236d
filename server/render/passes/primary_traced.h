// Pass `primary_traced`: primary hits by tracing into the visibility image.
#pragma once

#include "gpu/pipelines.h"
#include "render/passes/pass.h"

namespace helio::render {

class PrimaryTraced {
 public:
  explicit PrimaryTraced(gpu::Device& device);
  void add(const ViewPass& pass, const shared::SampleConstants& sample) const;

 private:
  gpu::RayTracingPipeline pipeline_;
};

}  // namespace helio::render
