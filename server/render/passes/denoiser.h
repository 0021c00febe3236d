// A denoiser: passes that turn the light of one sample a pixel into a picture.
#pragma once

#include "render/passes/pass.h"

namespace helio::render {

class DenoiserPasses {
 public:
  virtual ~DenoiserPasses() = default;
  /// Ahead of the pass `path_trace`, which may be told what to sample.
  virtual void addAhead(const ViewPass& /*pass*/) const {}
  /// Behind the tick's own samples and `motion`, ahead of further paths (render/passes/extra_samples.h).
  virtual void addBetween(const ViewPass& /*pass*/, const shared::SampleConstants& /*sample*/) const {}
  /// From the light by lobe and what the view keeps of the ticks before (render/histories.h) to the image `radiance`.
  /// `sample`: push constants of the tick's last sample; `last`: of what stands behind the samples.
  virtual void add(const ViewPass& pass, const shared::SampleConstants& sample,
                   const shared::SampleConstants& last) const = 0;
};

}  // namespace helio::render
