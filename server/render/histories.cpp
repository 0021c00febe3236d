#include "render/histories.h"

#include <algorithm>
#include <cmath>

#include "render/camera_frame.h"
#include "shared/gradients.h"

namespace helio::render {
namespace {

/// Powers of two that still are floats when light is multiplied or divided by them.
constexpr float kMostStops = 40.0f;

/// The power of two next to an exposure.
float unitOf(float exposure) {
  if (!(exposure > 0.0f)) return 1.0f;
  return std::exp2(std::clamp(std::round(std::log2(exposure)), -kMostStops, kMostStops));
}

}  // namespace

void Histories::begin(gpu::Commands& commands, const scene::Camera& camera, const ViewSettings& settings, uint64_t tick,
                      bool goes_on, float exposure, uint32_t last_seed) {
  if (!looksBack(settings)) {
    *this = Histories(*device_);
    return;
  }
  const bool fits = motion && width_ == settings.width && height_ == settings.height &&
                    split_ == splitsLight(settings) && denoiser_ == settings.denoiser && taa_ == settings.taa &&
                    reconstructs_ == reconstructs(settings) && occlusion_apart_ == occlusionGoesApart(settings);
  if (!fits) makeImages(commands, settings);
  if (settings.poison_history) poison(commands);
  now_ = 1 - now_;

  const float previous_unit = constants_.unit;
  const uint32_t known_before = constants_.known;
  constants_ = {};
  constants_.tick = static_cast<uint32_t>(tick);
  constants_.gradient_seed = last_seed;
  const bool looks_back = fits && goes_on && known_ && tick == tick_ + 1;
  constants_.known = looks_back ? known_before + 1 : 0;
  const CameraFrame before = cameraFrame(looks_back ? camera_ : camera);
  constants_.position = looks_back ? camera_.position : camera.position;
  constants_.right = before.right;
  constants_.up = before.up;
  constants_.forward = before.forward;
  constants_.tangent = before.tangent;
  constants_.unit = unitOf(exposure);
  constants_.rescale = looks_back ? constants_.unit / previous_unit : 1.0f;
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
  taa_ = settings.taa;
  reconstructs_ = reconstructs(settings);
  occlusion_apart_ = occlusionGoesApart(settings);
  // A texel a square of `side` pixels.
  const auto image = [&](const char* name, VkFormat format, uint64_t texel_bytes, uint32_t side = 1) {
    const uint32_t width = (width_ + side - 1) / side, height = (height_ + side - 1) / side;
    gpu::Image made(*device_,
                    {name, width, height, 1, format, VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT,
                     gpu::MemoryCategory::path_tracing});
    commands.prepare(made);
    bytes_ += texel_bytes * width * height;
    return made;
  };
  const auto half4 = [&](const char* name) { return image(name, VK_FORMAT_R16G16B16A16_SFLOAT, 8); };
  const auto words = [&](const char* name) { return image(name, VK_FORMAT_R32G32_UINT, 8); };
  const auto half2 = [&](const char* name) { return image(name, VK_FORMAT_R16G16_SFLOAT, 4); };
  buffer =
      gpu::Buffer(*device_, {"where things were", sizeof(shared::HistoryConstants), gpu::MemoryCategory::path_tracing});
  motion = half4("motion");
  if (taa_) antialiased = words("the anti-aliased picture");
  if (taa_ && !split_) resolved_ = words("the anti-aliased picture on its way");
  if (!split_) return;
  surfaces_ = {words("surfaces"), words("surfaces of the tick before")};
  albedos = words("albedos");
  emission = image("emission", VK_FORMAT_R32_UINT, 4);
  for (Light* light : {&sampled, &spare}) *light = {words("light by lobe"), half2("deviations of light")};
  const auto buffer_of = [&](const char* name, uint64_t bytes) {
    bytes_ += bytes;
    return gpu::Buffer(*device_, {name, bytes, gpu::MemoryCategory::path_tracing});
  };
  if (reconstructs_)
    indirect = buffer_of("indirect light of pixels", uint64_t{width_} * height_ * sizeof(shared::IndirectSample));
  if (denoiser_ == Denoiser::none) return;
  filtered = words("light of the ticks before");
  const auto bytes = [&](const char* name) { return image(name, VK_FORMAT_R8G8_UNORM, 2); };
  samples = bytes("ticks of light");
  if (occlusion_apart_) {
    occlusion = bytes("ambient occlusion");
    open_skies_ = {bytes("open sky"), bytes("open sky of the tick before")};
  }
  if (denoiser_ == Denoiser::reblur) {
    stabilised = half2("luminance that was shown");
    sunlight_ = half2("the sun's light");  // its spare deviations hold that luminance meanwhile
    for (uint32_t level = 0; level < shared::kHistoryMips; ++level)
      mips[level] = image("coarser light", VK_FORMAT_R32G32_UINT, 8, 2u << level);
    return;
  }
  moments = words("moments of light");
  if (denoiser_ != Denoiser::asvgf) return;
  using shared::kStratum;
  claims = image("claims of strata", VK_FORMAT_R32_UINT, 4, kStratum);
  changes = image("changes of light", VK_FORMAT_R8G8_UNORM, 2, kStratum);
  gradient_samples =
      buffer_of("samples to shade again", uint64_t{claims.width()} * claims.height() * sizeof(shared::GradientSample));
}

void Histories::poison(gpu::Commands& commands) const {
  commands.barrier(gpu::use::everything, gpu::use::transfer_write);
  const VkImageSubresourceRange all{VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
  VkClearColorValue nan{{std::nanf(""), std::nanf(""), std::nanf(""), std::nanf("")}}, words_of_nan{};
  words_of_nan.uint32[0] = words_of_nan.uint32[1] = 0x7e007e00u;  // two 16-bit floats each
  const auto clear = [&](const gpu::Image& image, const VkClearColorValue& value) {
    if (image) vkCmdClearColorImage(commands.handle(), image.handle(), VK_IMAGE_LAYOUT_GENERAL, &value, 1, &all);
  };
  clear(samples, {});  // what is no number is 0 in 8 bits
  clear(stabilised, nan);
  clear(spare.deviation, nan);
  for (const gpu::Image* image : {&filtered, &moments, &antialiased}) clear(*image, words_of_nan);
  commands.barrier(gpu::use::transfer_write, gpu::use::everything);
}

void Histories::describeImages() {
  const auto slot = [](const gpu::Image& image) { return image ? image.slot() : 0u; };
  shared::HistoryConstants& c = constants_;
  c.motion = slot(motion);
  c.split = split_;
  c.jitters = taa_;
  c.surface = slot(surface());
  c.previous_surface = slot(previousSurface());
  c.albedos = slot(albedos);
  c.emission = slot(emission);
  c.sampled = slot(sampled.rgb);
  c.sampled_deviation = slot(sampled.deviation);
  if (denoiser_ != Denoiser::none) c.sunlight = slot(sunlight());
  c.occlusion = slot(occlusion);
  c.open_sky = slot(openSky());
  c.previous_open_sky = slot(open_skies_[1 - now_]);
  c.spare = slot(spare.rgb);
  c.spare_deviation = slot(spare.deviation);
  c.filtered = slot(filtered);
  c.moments = slot(moments);
  c.samples = slot(samples);
  c.stabilised = slot(stabilised);
  for (uint32_t level = 0; level < shared::kHistoryMips; ++level) c.mips[level] = slot(mips[level]);
  c.gradient_samples = gradient_samples ? gradient_samples.address() : 0;
  c.claims = slot(claims);
  c.changes = slot(changes);
}

}  // namespace helio::render
