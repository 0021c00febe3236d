// Pass `extra_samples`: chooses the pixels that get further paths in this tick, and how many each, where what is known
// of the light is young and noisy (shaders/shared/extra_samples.h). Recorded only where the settings ask for them.
#pragma once

#include "gpu/pipelines.h"
#include "render/passes/pass.h"

namespace helio::render {

/// The settings call for further paths.
inline bool takesExtraSamples(const ViewSettings& settings) { return settings.extra_samples > 0.0f; }

class ExtraSamplesPass {
 public:
  explicit ExtraSamplesPass(gpu::Device& device);
  /// Behind the tick's sample and `motion`. `sample`: that one.
  void add(const ViewPass& pass, const shared::SampleConstants& sample) const;

 private:
  gpu::ComputePipeline weigh_, share_, choose_, list_;
};

}  // namespace helio::render
