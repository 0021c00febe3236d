// Pass `culling_view`: what culling did, in the picture's place. Recorded only when asked for.
#pragma once

#include <array>

#include "gpu/pipelines.h"
#include "render/passes/pass.h"
#include "shared/culling_view.h"

namespace helio::render {

class CullingViewPass {
 public:
  explicit CullingViewPass(gpu::Device& device) : device_(device) {}
  /// `sample`: the one whose primary hits are in the visibility image.
  void add(const ViewPass& pass, const shared::SampleConstants& sample);

 private:
  gpu::Device& device_;
  std::array<gpu::ComputePipeline, shared::kCullingViews> variants_;  // made when they are first asked for
};

}  // namespace helio::render
