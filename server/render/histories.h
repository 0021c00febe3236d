// What a view keeps of the tick before, for passes that look back: motion vectors, surfaces, light by lobe, what a
// denoiser has gathered. Made when the settings call for it, and gone when they do not.
#pragma once

#include <array>

#include "gpu/commands.h"
#include "gpu/memory.h"
#include "render/renderer.h"
#include "shared/history.h"

namespace helio::render {

/// What is shown is made of this tick's light and what was kept, and not of samples alone.
inline bool replacesPicture(const ViewSettings& settings) {
  return settings.denoiser != Denoiser::none || settings.taa || settings.inspect != Inspect::nothing;
}
/// Some pixels look at their neighbours' indirect light.
inline bool reconstructs(const ViewSettings& settings) { return settings.indirect_rate != IndirectRate::full; }
/// The settings call for histories: motion and surfaces, at least.
inline bool looksBack(const ViewSettings& settings) { return replacesPicture(settings) || reconstructs(settings); }
/// Ambient occlusion is filtered by itself.
inline bool occlusionGoesApart(const ViewSettings& settings) {
  return settings.denoiser != Denoiser::none && settings.ambient == Ambient::occluded;
}
/// The settings call for light by the first vertex's lobes.
inline bool splitsLight(const ViewSettings& settings) {
  return settings.denoiser != Denoiser::none || settings.inspect == Inspect::unfiltered || reconstructs(settings);
}

class Histories {
 public:
  explicit Histories(gpu::Device& device) : device_(&device) {}

  /// Starts a tick. `goes_on`: what was kept shows this world under these settings at this size, if it is of the tick
  /// before. `exposure`: about what the picture will have, a factor on radiance. `last_seed`: of the tick before's last
  /// sample. Allocates, and records what new images need.
  void begin(gpu::Commands& commands, const scene::Camera& camera, const ViewSettings& settings, uint64_t tick,
             bool goes_on, float exposure, uint32_t last_seed);
  /// After a tick that failed.
  void forget() { known_ = false; }

  /// Of this tick, with the images' slots; where units were is left to the caller.
  const shared::HistoryConstants& constants() const { return constants_; }
  /// Bytes of all images.
  uint64_t bytes() const { return bytes_; }

  gpu::Buffer buffer;  // shared::HistoryConstants
  /// Light by lobe on its way through a denoiser, and its deviations.
  struct Light {
    gpu::Image rgb, deviation;
  };
  // shaders/shared/history.h says what each holds. Passes write to where what they are done with was, so that two
  // images of light are enough, and one each of what is kept.
  gpu::Image motion, albedos, emission;
  Light sampled, spare;
  gpu::Image filtered, moments, samples;
  /// Of temporal anti-aliasing: the mean over the ticks before.
  gpu::Image antialiased;
  /// That with this tick, on its way.
  const gpu::Image& resolved() const { return split_ ? spare.rgb : resolved_; }
  // Of A-SVGF (shaders/shared/gradients.h), a texel a stratum.
  gpu::Buffer gradient_samples;
  gpu::Image claims, changes;
  // Of ambient occlusion.
  gpu::Image occlusion;
  const gpu::Image& openSky() const { return open_skies_[now_]; }
  // Of ReBLUR.
  gpu::Image stabilised;
  std::array<gpu::Image, shared::kHistoryMips> mips;
  /// What pixels know of their neighbours' indirect light: shared::IndirectSample a pixel.
  gpu::Buffer indirect;
  const gpu::Image& surface() const { return surfaces_[now_]; }
  const gpu::Image& previousSurface() const { return surfaces_[1 - now_]; }
  /// Until a denoiser has taken it, in the place of what that writes then.
  const gpu::Image& sunlight() const { return denoiser_ == Denoiser::reblur ? sunlight_ : spare.deviation; }

 private:
  void makeImages(gpu::Commands& commands, const ViewSettings& settings);
  void poison(gpu::Commands& commands) const;
  void describeImages();

  gpu::Device* device_;
  std::array<gpu::Image, 2> surfaces_;  // of this tick and the one before, which take turns
  std::array<gpu::Image, 2> open_skies_;
  size_t now_ = 0;
  shared::HistoryConstants constants_{};
  scene::Camera camera_;
  gpu::Image resolved_, sunlight_;
  uint32_t width_ = 0, height_ = 0;
  bool split_ = false, taa_ = false, reconstructs_ = false, occlusion_apart_ = false;
  Denoiser denoiser_ = Denoiser::none;
  uint64_t tick_ = 0;
  bool known_ = false;  // the tick before was kept
  uint64_t bytes_ = 0;
};

}  // namespace helio::render
