// Pass `reconstruct`: where only every second or fourth pixel follows its path, all pixels get their indirect light
// from the rays around them (shaders/indirect/reconstruct.comp).
#pragma once

#include <array>

#include "gpu/pipelines.h"
#include "render/passes/pass.h"

namespace helio::render {

class Reconstruct {
 public:
  explicit Reconstruct(gpu::Device& device);
  /// Behind `path_trace` and `motion`: the light by lobe becomes whole, and where nothing else makes the picture it
  /// does.
  void add(const ViewPass& pass, const shared::SampleConstants& sample) const;

 private:
  std::array<std::array<gpu::ComputePipeline, 2>, 2> pipelines_;  // by quarter rate, and by reconstruction
};

}  // namespace helio::render
