#include "render/view.h"

#include <algorithm>
#include <cmath>

#include "render/passes/compute_raster.h"
#include "shared/raster.h"
#include "shared/shadow_map.h"

namespace helio::render {
namespace {

bool same(const scene::Camera& a, const scene::Camera& b) {
  return a.position == b.position && a.forward == b.forward && a.up == b.up && a.vfov == b.vfov;
}

/// What was accumulated under `a` may go on under `b`.
bool continues(const ViewSettings& a, const ViewSettings& b) {
  return a.mode == b.mode && a.primary == b.primary && a.bounces == b.bounces && a.roulette == b.roulette &&
         a.sampler == b.sampler && a.light_sampling == b.light_sampling && a.mis == b.mis &&
         a.sky_sampling == b.sky_sampling && a.lamp_samples == b.lamp_samples && a.light_lists == b.light_lists &&
         a.round_surfaces == b.round_surfaces && a.multiple_scattering == b.multiple_scattering &&
         a.regularisation == b.regularisation && a.sun_shadow == b.sun_shadow &&
         a.shadow_map_size == b.shadow_map_size && a.levels_of_detail == b.levels_of_detail &&
         a.technique == b.technique && a.ambient == b.ambient && a.ambient_radius == b.ambient_radius &&
         a.indirect_rate == b.indirect_rate && a.reconstruction == b.reconstruction && a.aperture == b.aperture &&
         a.focus == b.focus && a.light_feedback == b.light_feedback && a.materials == b.materials &&
         a.accumulate == b.accumulate && looksBack(a) == looksBack(b);
}

/// Numbers of any sign, which are no light.
bool showsNumbers(Inspect inspect) {
  return inspect == Inspect::motion || inspect == Inspect::position || inspect == Inspect::before ||
         inspect == Inspect::samples;
}

/// Low-discrepancy points of the unit square: the R2 sequence [Roberts 2018], from the centre on.
glm::vec2 pixelPosition(uint64_t index) {
  const double n = static_cast<double>(index);
  const auto fraction = [](double v) { return static_cast<float>(v - std::floor(v)); };
  return {fraction(0.5 + n * 0.7548776662466927), fraction(0.5 + n * 0.5698402909980532)};
}

/// A jump is a move farther than a fast flight makes in one tick, or a turn by more than 30 degrees: exposure adapts at
/// once.
bool isJump(const scene::Camera& from, const scene::Camera& to) {
  return glm::distance(from.position, to.position) > 25.0f ||
         glm::dot(glm::normalize(from.forward), glm::normalize(to.forward)) < 0.866f;
}

/// Pixels by which a turn moves the picture's middle.
float pixelsTurned(const scene::Camera& from, const scene::Camera& to, uint32_t height) {
  const float cosine = glm::dot(glm::normalize(from.forward), glm::normalize(to.forward));
  return std::acos(std::clamp(cosine, -1.0f, 1.0f)) / to.vfov * static_cast<float>(height);
}

constexpr float kQuickTurn = 4.0f;    // pixels a tick: by then they fall where they fall without our doing
constexpr uint32_t kLog2Block = 10;   // beyond 1024 samples the next block begins
constexpr float kAdaptation = 0.15f;  // share of the way to a new exposure, a tick

}  // namespace

std::shared_ptr<PixelPool::Lease> PixelPool::take() {
  std::unique_ptr<Lease> lease;
  {
    const std::lock_guard lock(mutex_);
    if (!free_.empty()) {
      lease = std::move(free_.back());
      free_.pop_back();
    }
  }
  if (!lease)
    lease.reset(new Lease{gpu::Buffer(
        *device_, {"a picture to read back", bytes_, gpu::MemoryCategory::transfer, gpu::Placement::readback})});
  // The deleter holds the pool, so a picture may outlive its view.
  return {lease.release(), [pool = shared_from_this()](Lease* returned) {
            const std::lock_guard lock(pool->mutex_);
            pool->free_.emplace_back(returned);
          }};
}

bool View::isAt(const scene::Camera& camera) const { return same(camera_, camera); }

bool View::computesShadows() const {
  return settings_.rasteriser == Rasteriser::compute ||
         (settings_.rasteriser == Rasteriser::automatic && !device_->cpu());
}

void View::begin(gpu::Commands& commands, const scene::Camera& camera, const ViewSettings& settings, bool scene_changed,
                 uint64_t tick, uint32_t ray_log_stride) {
  const bool resized = !pixels || settings.width != settings_.width || settings.height != settings_.height;
  jumped_ = resized || isJump(camera_, camera);
  const bool turns_quickly = !jumped_ && pixelsTurned(camera_, camera, settings.height) > kQuickTurn;
  const bool goes_on = !resized && !scene_changed && isAt(camera) && continues(settings_, settings);
  const bool was_accumulating = averaging();
  // Bounces more or fewer change little of the light: what looks back goes on from it.
  ViewSettings as_before = settings;
  as_before.bounces = settings_.bounces;
  const bool same_light = !resized && continues(settings_, as_before);
  camera_ = camera;
  settings_ = settings;
  if (showsProperty(settings.materials)) {  // numbers, not light
    settings_.auto_exposure = false;
    settings_.exposure_ev = 0.0f;
  }
  if (settings.mode == Mode::reference || showsProperty(settings.materials)) {
    settings_.denoiser = Denoiser::none;
    settings_.technique = Technique::path_traced;
    settings_.ambient = Ambient::none;
    settings_.indirect_rate = IndirectRate::full;
    settings_.light_feedback = false;
    settings_.extra_samples = 0.0f;
    settings_.taa = false;
    settings_.inspect = Inspect::nothing;
  }
  if (showsNumbers(settings_.inspect)) settings_.auto_exposure = false;
  if (resized) createTargets(commands);
  histories.begin(commands, camera, settings_, tick, same_light,
                  settings_.auto_exposure ? last_exposure_ : std::exp2(settings_.exposure_ev), seed_);
  still_ = goes_on && settings.accumulate && settings.mode == Mode::hybrid;
  const bool keeps = settings.mode == Mode::reference || settings.accumulate;
  if (!goes_on || !keeps || !was_accumulating) accumulated_ = 0;
  tick_jitter_ = settings_.taa && !still_ && !turns_quickly  ? pixelPosition(tick)
                 : settings_.technique == Technique::whitted ? glm::vec2(0.5f)
                 : accumulating()                            ? pixelPosition(accumulated_)
                                                             : glm::vec2(0.5f);

  const uint64_t texels = uint64_t{settings.width} * settings.height;
  makeRasterTargets(commands);
  if (settings.keep_radiance && radiance_readback.size() < texels * 16)
    radiance_readback = gpu::Buffer(
        *device_, {"radiance to read back", texels * 16, gpu::MemoryCategory::transfer, gpu::Placement::readback});
  const uint64_t log_bytes = settings.measure_bare_trace ? texels * ray_log_stride * sizeof(shared::RayLogEntry) : 0;
  if (ray_log.size() < log_bytes)
    ray_log = gpu::Buffer(*device_, {"the ray log", log_bytes, gpu::MemoryCategory::transfer});
  pixels_readback = pool_->take();
}

void View::makeRasterTargets(gpu::Commands& commands) {
  const bool primary = settings_.mode == Mode::hybrid && settings_.primary == Primary::raster;
  const bool shadows = settings_.sun_shadow != SunShadow::rays;
  const uint64_t texels = uint64_t{settings_.width} * settings_.height;
  if (!primary || computesPrimary()) depth = {};
  if (!primary || !computesPrimary()) keys = {};
  const uint64_t shadow_side = uint64_t{shared::kShadowTilesPerRow} * settings_.shadow_map_size;
  uint64_t working = 0;
  if (primary && computesPrimary())
    working = ComputeRaster::workingBytes(1, settings_.width, settings_.height, texels / shared::kPixelsAPart);
  if (shadows && computesShadows())
    working = std::max(working, ComputeRaster::workingBytes(shared::kShadowCascades, settings_.shadow_map_size,
                                                            settings_.shadow_map_size,
                                                            shadow_side * shadow_side / shared::kShadowTexelsAPart));
  if (working == 0) raster_parts = {};
  else if (raster_parts.size() != working)
    raster_parts = gpu::Buffer(*device_, {"parts of large triangles", working, gpu::MemoryCategory::raster});
  if (primary && computesPrimary() && keys.size() != texels * sizeof(uint64_t))
    keys = gpu::Buffer(*device_, {"who is nearest", texels * sizeof(uint64_t), gpu::MemoryCategory::raster});
  if (primary && !computesPrimary() && !depth) {
    depth = gpu::Image(*device_, {"depth", settings_.width, settings_.height, 1, VK_FORMAT_D32_SFLOAT,
                                  VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT});
    commands.prepare(depth);
  }
  if (shadows && (!shadow_image || shadow_image.width() != shadow_side || shadow_bits_ != computesShadows())) {
    const auto side = static_cast<uint32_t>(shadow_side);
    shadow_bits_ = computesShadows();
    const VkImageUsageFlags bits = VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT;
    const VkImageUsageFlags drawn = VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT | VK_IMAGE_USAGE_SAMPLED_BIT;
    shadow_image =
        gpu::Image(*device_, {"the sun's shadow map", side, side, 1,
                              shadow_bits_ ? VK_FORMAT_R32_UINT : VK_FORMAT_D32_SFLOAT, shadow_bits_ ? bits : drawn});
    commands.prepare(shadow_image);
    shadow_constants =
        gpu::Buffer(*device_, {"the shadow map's cascades", sizeof(shared::ShadowMap), gpu::MemoryCategory::raster});
  }
}

void View::createTargets(gpu::Commands& commands) {
  pixels = {};  // should an allocation below fail, the next tick begins here again
  const uint32_t w = settings_.width, h = settings_.height;
  const uint64_t texels = uint64_t{w} * h;
  const auto target = [&](const char* name, VkFormat format, VkImageUsageFlags usage, gpu::MemoryCategory category) {
    gpu::Image image(*device_, {name, w, h, 1, format,
                                usage | VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT, category});
    commands.prepare(image);
    return image;
  };
  using enum gpu::MemoryCategory;
  visibility = target("visibility", VK_FORMAT_R32G32_UINT, VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT, raster);
  radiance = target("radiance", VK_FORMAT_R32G32B32A32_SFLOAT, 0, path_tracing);
  accumulation = target("accumulation", VK_FORMAT_R32G32B32A32_SFLOAT, 0, path_tracing);
  path_info = target("path info", VK_FORMAT_R32_UINT, 0, path_tracing);
  constants = gpu::Buffer(*device_, {"frame constants", sizeof(shared::FrameConstants), raster});
  pixels = gpu::Buffer(*device_, {"the picture", texels * 4, raster});
  state = gpu::Buffer(*device_, {"view state", sizeof(shared::ViewState), raster});
  state_readback =
      gpu::Buffer(*device_, {"view state to read back", sizeof(shared::ViewState), transfer, gpu::Placement::readback});
  depth = {};
  keys = {};
  radiance_readback = {};
  ray_log = {};
  commands.fill(state, 0);
  last_exposure_ = 0.0f;
  pool_ = std::make_shared<PixelPool>(device_, texels * 4);
}

shared::SampleConstants View::nextSample() {
  shared::SampleConstants sample = finalConstants();
  sample.accumulated = accumulated_;
  // A reference image is a pure function of its inputs; a live view never repeats a seed.
  const bool reference = settings_.mode == Mode::reference;
  if (!accumulating() || accumulated_ == 0) seed_ = reference ? 0 : static_cast<uint32_t>(samples_drawn_);
  sample.seed = seed_;
  // What is averaged is well spread over a pixel's samples, a single sample over the pixels of the picture.
  sample.sample_index = accumulating() ? accumulated_ : 0;
  sample.log2_samples = accumulating() ? kLog2Block : 0;
  // A moving picture is sampled at the pixel's centre, a still one all over the pixel. Unless
  // samples lie apart, all of a tick have one position.
  sample.jitter = samplesApart() ? glm::vec2(-1.0f) : tick_jitter_;
  ++accumulated_;
  ++samples_drawn_;
  return sample;
}

shared::SampleConstants View::finalConstants() const {
  shared::SampleConstants constants_{};
  constants_.frame = constants.address();
  constants_.accumulated = accumulated_;
  constants_.exposure_bias = std::exp2(settings_.exposure_ev);
  constants_.adaptation = jumped_ || settings_.mode == Mode::reference ? 1.0f : kAdaptation;
  constants_.auto_exposure = settings_.auto_exposure;
  constants_.source = shown().slot();
  constants_.curve = showsNumbers(settings_.inspect)               ? shared::kCurveSigned
                     : settings_.culling_view != CullingView::none ? shared::kCurveColor
                     : !showsProperty(settings_.materials)         ? shared::kCurveTone
                     : showsColor(settings_.materials)             ? shared::kCurveColor
                                                                   : shared::kCurveNone;
  return constants_;
}

}  // namespace helio::render
