// A picture of one camera that grows sample by sample.
#pragma once

#include <functional>

#include "bench/image.h"
#include "scene/spec.h"
#include "support/viewed_world.h"

namespace helio::bench {

/// A world whose view stands still.
class Accumulation {
 public:
  /// `settings`: mode reference; samples and keep_radiance are set here. Errors: the renderer's.
  static Result<std::unique_ptr<Accumulation>> start(render::Renderer& renderer, scene::ScenePtr scene,
                                                     const scene::NamedCamera& camera,
                                                     const render::ViewSettings& settings);

  /// Goes on until the picture is the mean of `samples` a pixel, more than it has; `step` is called for each.
  Result<void> growTo(
      uint32_t samples, const std::function<void()>& step = [] {});

  Image image() const { return {frame_.pixels->width, frame_.pixels->height, frame_.radiance}; }
  const render::Pixels& pixels() const { return *frame_.pixels; }
  uint32_t samples() const { return samples_; }
  double gpuMs() const { return gpu_ms_; }
  uint64_t rays() const { return rays_; }
  uint64_t nonfinite() const { return nonfinite_; }

 private:
  Accumulation(std::unique_ptr<test::ViewedWorld> viewed, const scene::Camera& camera,
               const render::ViewSettings& settings);

  std::unique_ptr<test::ViewedWorld> viewed_;
  scene::Camera camera_;
  render::ViewSettings settings_;
  render::Frame frame_;
  uint32_t samples_ = 0;
  double gpu_ms_ = 0.0;
  uint64_t rays_ = 0, nonfinite_ = 0;
};

/// Reference mode at the size and bounces given: no roulette, no automatic exposure.
render::ViewSettings referenceSettings(uint32_t width, uint32_t height, uint32_t bounces);
/// The same as `spec` asks for, materials included.
render::ViewSettings specSettings(const scene::Spec& spec);

}  // namespace helio::bench
