// What the tests of denoisers and anti-aliasing share: a live view's settings, the truth, and how far a picture is from
// it.
#pragma once

#include <cmath>

#include "render/metrics/image.h"
#include "support/scenes.h"
#include "support/stage.h"

namespace helio::test {

inline constexpr uint32_t kPictureWidth = 96, kPictureHeight = 54;

/// One sample a pixel in fixed exposure, no average over ticks; the picture as linear radiance too.
inline render::ViewSettings live(render::Denoiser denoiser, render::Primary primary = render::Primary::traced) {
  render::ViewSettings settings;
  settings.width = kPictureWidth;
  settings.height = kPictureHeight;
  settings.primary = primary;
  settings.denoiser = denoiser;
  settings.auto_exposure = false;
  settings.keep_radiance = true;
  settings.accumulate = false;
  return settings;
}

/// Mean over pixels and channels of (a - b)^2 / (b^2 + 0.01).
inline double relativeMse(const render::Frame& a, const render::Frame& b) {
  double sum = 0.0;
  for (size_t i = 0; i < a.radiance.size(); ++i) sum += metrics::relativeSquare(a.radiance[i], b.radiance[i]);
  return sum / static_cast<double>(a.radiance.size());
}

/// Texels that are no light.
inline size_t brokenTexels(const render::Frame& frame) {
  size_t count = 0;
  for (const float value : frame.radiance) count += !std::isfinite(value) || value < 0.0f;
  return count;
}

/// What a denoiser may keep at 1920 x 1080, in MB: ReBLUR as published takes between 148 and 169.
inline constexpr double kMostMegabytes = 169.0;
/// What the frame's view keeps, at that size.
inline double historyMegabytes(const render::Frame& frame) {
  return static_cast<double>(frame.stats.history_bytes) / (kPictureWidth * kPictureHeight) * 1920 * 1080 * 1e-6;
}

/// The converged picture of 768 samples a pixel, all over the pixel.
inline render::Frame truth(const scene::ScenePtr& scene, const scene::Camera& camera) {
  Stage stage(scene);
  render::ViewSettings settings = referenceSettings(kPictureWidth, kPictureHeight);
  settings.bounces = 3;
  settings.samples = 64;
  settings.roulette = true;
  return stage.accumulate(camera, settings, 12);
}

}  // namespace helio::test
