// A denoiser: passes that turn the light of one sample a pixel into a picture.
#pragma once

#include "render/passes/pass.h"

namespace helio::render {

class DenoiserPasses {
 public:
  virtual ~DenoiserPasses() = default;
  /// From the light by lobe and what the view keeps of the ticks before (render/histories.h) to the image `radiance`.
  /// `last`: push constants behind the samples.
  virtual void add(const ViewPass& pass, const shared::SampleConstants& last) const = 0;
};

}  // namespace helio::render
