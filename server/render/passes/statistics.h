// Pass `statistics`: sums up rays by kind and dropped samples.
#pragma once

#include "gpu/pipelines.h"
#include "render/passes/pass.h"

namespace helio::render {

class Statistics {
 public:
  explicit Statistics(gpu::Device& device);
  void add(const ViewPass& pass, const shared::SampleConstants& sample) const;
  /// The same of a round of further paths, within their pass.
  void recordRound(gpu::Commands& commands, const PathQueue& paths, const shared::SampleConstants& sample) const;

 private:
  gpu::ComputePipeline pipeline_;
};

}  // namespace helio::render
