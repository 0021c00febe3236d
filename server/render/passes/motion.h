// Pass `motion`: from each pixel to where its surface was in the tick before. Recorded only where something looks back.
#pragma once

#include "gpu/pipelines.h"
#include "render/passes/pass.h"

namespace helio::render {

class Motion {
 public:
  explicit Motion(gpu::Device& device) : pipeline_(device, "motion/motion.comp") {}
  /// `sample`: the one whose primary hits are in the visibility image.
  void add(const ViewPass& pass, const shared::SampleConstants& sample) const;

 private:
  gpu::ComputePipeline pipeline_;
};

}  // namespace helio::render
