// Pass `accumulate`: running mean over samples.
#pragma once

#include "gpu/pipelines.h"
#include "render/passes/pass.h"

namespace helio::render {

class Accumulate {
 public:
  explicit Accumulate(gpu::Device& device);
  void add(const ViewPass& pass, const shared::SampleConstants& sample) const;

 private:
  gpu::ComputePipeline pipeline_;
};

}  // namespace helio::render
