#include "render/histories.h"

#include <algorithm>
#include <cmath>

#include "render/camera_frame.h"

namespace helio::render {
namespace {

/// Ticks whose light is averaged at most: with a least share of 0.05 a new one counts for, more have no weight.
constexpr float kMostTicks = 64.0f;
/// Powers of two that still are floats when light is multiplied or divided by them.
constexpr float kMostStops = 40.0f;

/// The power of two next to an exposure.
float unitOf(float exposure) {
  if (!(exposure > 0.0f)) return 1.0f;
  return std::exp2(std::clamp(std::round(std::log2(exposure)), -kMostStops, kMostStops));
}

}  // namespace

void Histories::begin(gpu::Commands& commands, const scene::Camera& camera, const ViewSettings& settings, uint64_t tick,
                      bool goes_on, float exposure) {
  if (!looksBack(settings)) {
    *this = Histories(*device_);
    return;
  }
  const bool fits = motion && width_ == settings.width && height_ == settings.height &&
                    split_ == splitsLight(settings) && denoiser_ == settings.denoiser;
  if (!fits) makeImages(commands, settings);
  if (settings.poison_history) poison(commands);
  now_ = 1 - now_;

  const float previous_unit = constants_.unit;
  constants_ = {};
  constants_.valid = fits && goes_on && known_ && tick == tick_ + 1;
  const CameraFrame before = cameraFrame(constants_.valid ? camera_ : camera);
  constants_.position = constants_.valid ? camera_.position : camera.position;
  constants_.right = before.right;
  constants_.up = before.up;
  constants_.forward = before.forward;
  constants_.tangent = before.tangent;
  constants_.unit = unitOf(exposure);
  constants_.rescale = constants_.valid ? constants_.unit / previous_unit : 1.0f;
  constants_.most_samples = kMostTicks;
  describeImages();
  camera_ = camera;
  tick_ = tick;
  known_ = true;
}

void Histories::makeImages(gpu::Commands& commands, const ViewSettings& settings) {
  *this = Histories(*device_);
  width_ = settings.width;
  height_ = settings.height;
  split_ = splitsLight(settings);
  denoiser_ = settings.denoiser;
  const auto image = [&](const char* name, VkFormat format, uint64_t texel_bytes) {
    gpu::Image made(*device_,
                    {name, width_, height_, 1, format, VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT,
                     gpu::MemoryCategory::path_tracing});
    commands.prepare(made);
    bytes_ += texel_bytes * width_ * height_;
    return made;
  };
  const auto light = [&](const char* name) { return image(name, VK_FORMAT_R16G16B16A16_SFLOAT, 8); };
  buffer =
      gpu::Buffer(*device_, {"where things were", sizeof(shared::HistoryConstants), gpu::MemoryCategory::path_tracing});
  motion = light("motion");
  if (split_) {
    surfaces_[0] = image("surfaces", VK_FORMAT_R32G32_UINT, 8);
    albedos = image("albedos", VK_FORMAT_R32G32_UINT, 8);
    emission = light("emission");
    diffuse = light("diffuse light");
    specular = light("specular light");
  }
  if (denoiser_ == Denoiser::none) {
    if (split_) surfaces_[1] = image("surfaces", VK_FORMAT_R32G32_UINT, 8);
    return;
  }
  surfaces_[1] = image("surfaces of the tick before", VK_FORMAT_R32G32_UINT, 8);
  for (size_t signal = 0; signal < 2; ++signal) {
    integrated[signal] = light("integrated light");
    filtered[signal] = light("filtered light");
  }
  for (size_t tick = 0; tick < 2; ++tick) {
    moments_[tick] = light("moments of light");
    samples_[tick] = image("samples of light", VK_FORMAT_R16G16_SFLOAT, 4);
  }
}

void Histories::poison(gpu::Commands& commands) const {
  if (denoiser_ == Denoiser::none) return;
  commands.barrier(gpu::use::everything, gpu::use::transfer_write);
  const VkClearColorValue nan{{std::nanf(""), std::nanf(""), std::nanf(""), std::nanf("")}};
  const VkImageSubresourceRange all{VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
  for (const gpu::Image* image : {&filtered[0], &filtered[1], &moments_[0], &moments_[1], &samples_[0], &samples_[1]})
    vkCmdClearColorImage(commands.handle(), image->handle(), VK_IMAGE_LAYOUT_GENERAL, &nan, 1, &all);
  commands.barrier(gpu::use::transfer_write, gpu::use::everything);
}

void Histories::describeImages() {
  const auto slot = [](const gpu::Image& image) { return image ? image.slot() : 0u; };
  shared::HistoryConstants& c = constants_;
  c.motion = slot(motion);
  c.surface = slot(surface());
  c.previous_surface = slot(previousSurface());
  c.albedos = slot(albedos);
  c.emission = slot(emission);
  c.diffuse = slot(diffuse);
  c.specular = slot(specular);
  for (size_t signal = 0; signal < 2; ++signal) {
    c.integrated[signal] = slot(integrated[signal]);
    c.filtered[signal] = slot(filtered[signal]);
  }
  c.moments = slot(moments());
  c.previous_moments = slot(previousMoments());
  c.samples = slot(samples());
  c.previous_samples = slot(previousSamples());
}

}  // namespace helio::render
