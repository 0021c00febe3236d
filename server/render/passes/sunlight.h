// Pass `sunlight`: the sun's light on what pixels show, whose shadow alone is filtered, joins what no denoiser filters.
#pragma once

#include "gpu/pipelines.h"
#include "render/passes/pass.h"

namespace helio::render {

/// There is a sun, and a denoiser that need not know its shadows.
inline bool sunGoesApart(const ViewSettings& settings, effects::EffectSet effects) {
  return settings.denoiser != Denoiser::none && effects.has(effects::Effect::sun);
}

class Sunlight {
 public:
  explicit Sunlight(gpu::Device& device) : pipeline_(device, "sunlight/sunlight.comp") {}
  void add(const ViewPass& pass, const shared::SampleConstants& sample) const;

 private:
  gpu::ComputePipeline pipeline_;
};

}  // namespace helio::render
