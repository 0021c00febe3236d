// A world that stands still in a copy of its own, and a reference picture of it that converges sample by sample.
#pragma once

#include <memory>

#include "render/metrics/image.h"
#include "render/renderer.h"

namespace helio::render {

/// Reference mode for what `live` shows: size, materials and light transport as they are, every approximation off.
/// `exposure`: the live picture's factor on radiance; the reference is shown with the same.
ViewSettings referenceOf(const ViewSettings& live, uint32_t bounces, double exposure);

/// A world with one view, on a renderer that may tick other worlds at the same time. Not thread-safe.
class ReferencePicture {
 public:
  /// `whole`: all of the world, as World::beginTick() hands it out; nothing that happens to the world later is seen.
  /// Errors: the renderer's, out of memory among them (limit): the copy takes as much as the world does.
  static Result<std::unique_ptr<ReferencePicture>> make(Renderer& renderer, scene::ScenePtr scene,
                                                        world::ChangeSet whole, const scene::Camera& camera,
                                                        const ViewSettings& settings);
  ~ReferencePicture();
  ReferencePicture(const ReferencePicture&) = delete;
  ReferencePicture& operator=(const ReferencePicture&) = delete;

  /// One tick of `samples` more a pixel. While the copy's acceleration structures are being completed the mean begins
  /// again. Errors: the renderer's.
  Result<void> grow(uint32_t samples);

  /// Samples a pixel behind image() and pixels(); 0: grow() was not called yet.
  uint32_t samples() const { return frame_.pixels ? frame_.stats.accumulated : 0; }
  metrics::Image image() const;
  const Pixels& pixels() const { return *frame_.pixels; }
  /// Of all ticks together.
  double gpuMs() const { return gpu_ms_; }

 private:
  ReferencePicture(Renderer& renderer, world::ChangeSet whole, const scene::Camera& camera,
                   const ViewSettings& settings)
      : renderer_(renderer), changes_(std::move(whole)), camera_(camera), settings_(settings) {}

  Renderer& renderer_;
  world::ChangeSet changes_;  // of the next tick: everything, then nothing
  scene::Camera camera_;
  ViewSettings settings_;
  WorldHandle world_ = 0;
  ViewHandle view_ = 0;
  Frame frame_;
  double gpu_ms_ = 0.0;
};

}  // namespace helio::render
