// Pass `tonemap`: exposure, Khronos PBR Neutral, sRGB, 8 bits.
#pragma once

#include "gpu/pipelines.h"
#include "render/passes/pass.h"

namespace helio::render {

class Tonemap {
 public:
  explicit Tonemap(gpu::Device& device);
  void add(const ViewPass& pass, const shared::SampleConstants& sample) const;

 private:
  gpu::ComputePipeline pipeline_;
};

}  // namespace helio::render
