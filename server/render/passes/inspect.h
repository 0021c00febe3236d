// Pass `inspect`: numbers in the picture's place. Recorded only when asked for.
#pragma once

#include <array>

#include "gpu/pipelines.h"
#include "render/passes/pass.h"

namespace helio::render {

class InspectPass {
 public:
  explicit InspectPass(gpu::Device& device) : device_(device) {}
  /// `sample`: the one whose primary hits are in the visibility image.
  void add(const ViewPass& pass, const shared::SampleConstants& sample);

 private:
  gpu::Device& device_;
  std::array<gpu::ComputePipeline, shared::kInspects> variants_;  // made when they are first asked for
};

}  // namespace helio::render
