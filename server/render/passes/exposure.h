// Passes `histogram` and `exposure`: automatic exposure from the picture's luminances. Recorded only when asked for.
#pragma once

#include "gpu/pipelines.h"
#include "render/passes/pass.h"

namespace helio::render {

class Exposure {
 public:
  explicit Exposure(gpu::Device& device);
  void add(const ViewPass& pass, const shared::SampleConstants& sample) const;

 private:
  gpu::ComputePipeline histogram_;
  gpu::ComputePipeline exposure_;
};

}  // namespace helio::render
