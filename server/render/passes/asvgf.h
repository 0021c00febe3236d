// Passes `asvgf_project`, `asvgf_gradient` and SVGF's own: adaptive spatiotemporal variance-guided filtering [Schied et
// al. 2018, Gradient estimation for real-time adaptive temporal filtering]. One sample of nine of the tick before is
// shaded again with its random numbers; how much it changed shortens the history around it. Nothing that was filtered
// returns to the mean.
#pragma once

#include "render/passes/svgf.h"

namespace helio::render {

class Asvgf : public DenoiserPasses {
 public:
  explicit Asvgf(gpu::Device& device);
  void addAhead(const ViewPass& pass) const override;
  /// Gradients compare single samples with themselves: before further paths join them.
  void addBetween(const ViewPass& pass, const shared::SampleConstants& sample) const override;
  void add(const ViewPass& pass, const shared::SampleConstants& sample,
           const shared::SampleConstants& last) const override;

 private:
  gpu::ComputePipeline project_, gradient_, choose_, atrous_;
  Svgf filter_;
};

}  // namespace helio::render
