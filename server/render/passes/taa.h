// Pass `taa`: temporal anti-aliasing. The picture becomes its running mean along the motion over ticks that look at
// different points of the pixels, cut to what the neighbourhood has now [Karis 2014; Lipp 2021, section 6.12].
#pragma once

#include "gpu/pipelines.h"
#include "render/passes/pass.h"

namespace helio::render {

class Taa {
 public:
  explicit Taa(gpu::Device& device) : resolve_(device, "taa/resolve.comp"), show_(device, "taa/show.comp") {}
  /// Behind what makes the image `radiance`, which it replaces.
  void add(const ViewPass& pass) const;

 private:
  gpu::ComputePipeline resolve_, show_;
};

}  // namespace helio::render
