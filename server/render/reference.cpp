#include "render/reference.h"

#include <algorithm>
#include <cmath>

namespace helio::render {

ViewSettings referenceOf(const ViewSettings& live, uint32_t bounces, double exposure) {
  ViewSettings settings = live;
  settings.mode = Mode::reference;
  settings.bounces = bounces;
  settings.roulette = true;  // unbiased, and bounces are many
  // Live pictures are made of the low-discrepancy points: noise that both had in common would not count as error.
  settings.sampler = Sampler::independent;
  settings.accumulate = true;
  settings.keep_radiance = true;
  settings.auto_exposure = false;
  settings.exposure_ev = static_cast<float>(std::clamp(std::log2(std::max(exposure, 1e-9)), -16.0, 16.0));
  // Reference mode takes no approximation; these would be refused without the rest of them.
  settings.sun_shadow = SunShadow::rays;
  settings.denoiser = Denoiser::none;
  settings.taa = false;
  settings.inspect = Inspect::nothing;
  settings.culling_view = CullingView::none;
  settings.regularisation = 0.0f;
  return settings;
}

Result<std::unique_ptr<ReferencePicture>> ReferencePicture::make(Renderer& renderer, scene::ScenePtr scene,
                                                                 world::ChangeSet whole, const scene::Camera& camera,
                                                                 const ViewSettings& settings) {
  if (auto valid = check(settings); !valid) return valid.error();
  std::unique_ptr<ReferencePicture> picture(new ReferencePicture(renderer, std::move(whole), camera, settings));
  auto world = renderer.addWorld(std::move(scene));
  if (!world) return world.error();
  picture->world_ = *world;
  auto view = renderer.addView(*world);
  if (!view) return view.error();
  picture->view_ = *view;
  return picture;
}

ReferencePicture::~ReferencePicture() {
  frame_ = {};
  if (view_ != 0) renderer_.removeView(view_);
  if (world_ != 0) renderer_.removeWorld(world_);
}

Result<void> ReferencePicture::grow(uint32_t samples) {
  settings_.samples = samples;
  const ViewRequest request{view_, camera_, settings_};
  auto frames = renderer_.tick(world_, changes_, {&request, 1});
  if (!frames) return frames.error();
  frame_ = std::move(frames->front());
  gpu_ms_ += frame_.stats.gpu_ms;
  changes_.slots.clear();
  changes_.environment_changed = false;
  ++changes_.tick;
  return {};
}

metrics::Image ReferencePicture::image() const {
  return {frame_.pixels->width, frame_.pixels->height, frame_.radiance};
}

}  // namespace helio::render
