// What one viewer's camera keeps on the GPU from tick to tick: targets, accumulation, exposure, read-back.
#pragma once

#include <memory>
#include <mutex>

#include "gpu/commands.h"
#include "gpu/memory.h"
#include "render/draw_lists.h"
#include "render/histories.h"
#include "render/renderer.h"
#include "shared/frame.h"

namespace helio::render {

/// Mapped buffers that pictures are read back into; a buffer returns when the last holder of its picture lets go.
class PixelPool : public std::enable_shared_from_this<PixelPool> {
 public:
  /// Keeps the device alive: pictures may outlive the renderer.
  PixelPool(std::shared_ptr<gpu::Device> device, uint64_t bytes) : device_(std::move(device)), bytes_(bytes) {}

  struct Lease {
    gpu::Buffer buffer;
  };
  std::shared_ptr<Lease> take();

 private:
  std::shared_ptr<gpu::Device> device_;
  uint64_t bytes_;
  std::mutex mutex_;
  std::vector<std::unique_ptr<Lease>> free_;
};

class View {
 public:
  explicit View(std::shared_ptr<gpu::Device> device) : histories(*device), device_(std::move(device)) {}

  /// Makes the targets fit, decides whether accumulation goes on, and starts a tick.
  void begin(gpu::Commands& commands, const scene::Camera& camera, const ViewSettings& settings, bool scene_changed,
             uint64_t tick, uint32_t ray_log_stride);

  // ---- Targets (shaders/shared/frame.h says what each holds) ----
  gpu::Image visibility, radiance, accumulation, path_info;
  gpu::Buffer constants, state, pixels, ray_log;
  // Of the rasteriser: by the graphics pipeline, or by compute shaders (shared/raster.h).
  gpu::Image depth;
  gpu::Buffer keys, raster_parts;
  DrawLists draws;
  // With a shadow map of the sun.
  gpu::Image shadow_image;
  gpu::Buffer shadow_constants;
  DrawLists shadow_draws;
  gpu::Buffer state_readback, radiance_readback;
  std::shared_ptr<PixelPool::Lease> pixels_readback;
  Histories histories;

  bool counts_hits = false;  ///< in this tick

  const scene::Camera& camera() const { return camera_; }
  bool isAt(const scene::Camera& camera) const;  ///< the last tick's
  /// Compute shaders rasterise the primary hits, and shadow maps. A CPU computes the former faster than it draws them
  /// (1.1 to 2 times), and the latter's many texels 5 times slower.
  bool computesPrimary() const { return settings_.rasteriser != Rasteriser::graphics; }
  bool computesShadows() const;
  const ViewSettings& settings() const { return settings_; }
  /// Several samples are averaged: in reference mode, with several a tick, and while a live picture stands still.
  bool accumulating() const { return still_ || settings_.samples > 1 || settings_.mode == Mode::reference; }
  /// Each sample looks at a point of its pixel of its own: not where hits are rasterised, which all see one point in a
  /// tick, not for what looks back, which knows one surface a pixel and tick, and Whitted's technique draws no numbers.
  bool samplesApart() const {
    return accumulating() && (settings_.primary == Primary::traced || settings_.mode == Mode::reference) &&
           !looksBack(settings_) && settings_.technique != Technique::whitted;
  }
  /// Samples look at different points of their pixel, be it from tick to tick.
  bool spreadsSamples() const {
    return settings_.technique != Technique::whitted && (settings_.taa || still_ || samplesApart());
  }
  /// After a tick that failed: everything is made anew at the next.
  void forget() {
    pixels = {};
    histories.forget();
  }
  /// Live, and nothing has changed since the last tick: samples are averaged from tick to tick.
  bool still() const { return still_; }
  /// What is denoised or inspected takes the sample's place; its plain mean serves a picture that stands still alone.
  bool averaging() const { return replacesPicture(settings_) ? still_ : accumulating(); }
  const gpu::Image& shown() const {
    return accumulating() && !replacesPicture(settings_) && settings_.culling_view == CullingView::none ? accumulation
                                                                                                        : radiance;
  }

  /// Push constants of the next sample of this tick.
  shared::SampleConstants nextSample();
  /// Push constants of the passes behind the samples.
  shared::SampleConstants finalConstants() const;
  uint32_t accumulated() const { return accumulated_; }
  /// Exposure of the last picture, 0 before the first.
  float lastExposure() const { return last_exposure_; }
  void setLastExposure(float exposure) { last_exposure_ = exposure; }

 private:
  void createTargets(gpu::Commands& commands);
  void makeRasterTargets(gpu::Commands& commands);

  std::shared_ptr<gpu::Device> device_;
  std::shared_ptr<PixelPool> pool_;
  scene::Camera camera_;
  ViewSettings settings_;
  uint64_t samples_drawn_ = 0;  // since the view was made: live seeds never repeat
  uint32_t accumulated_ = 0;
  uint32_t seed_ = 0;
  float last_exposure_ = 0.0f;
  glm::vec2 tick_jitter_{0.5f};
  bool still_ = false;  // live, accumulate is on, and nothing has changed since the last tick
  bool jumped_ = true;
  bool shadow_bits_ = false;  // the shadow map's depths are bits of integers
};

}  // namespace helio::render
