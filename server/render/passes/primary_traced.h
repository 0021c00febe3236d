// Pass `primary_traced`: primary hits by tracing into the visibility image.
#pragma once

#include <array>

#include "gpu/pipelines.h"
#include "render/passes/pass.h"

namespace helio::render {

class PrimaryTraced {
 public:
  explicit PrimaryTraced(gpu::Device& device);
  void add(const ViewPass& pass, const shared::SampleConstants& sample, effects::EffectSet effects) const;

 private:
  std::array<gpu::RayTracingPipeline, 2> pipelines_;  // without and with alpha masks
};

}  // namespace helio::render
