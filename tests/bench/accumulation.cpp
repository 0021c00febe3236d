#include "bench/accumulation.h"

#include <algorithm>

namespace helio::bench {
namespace {

constexpr uint32_t kSamplesPerTick = 4;  // so that progress is seen

}  // namespace

Accumulation::Accumulation(render::Renderer& renderer, scene::ScenePtr scene, const scene::NamedCamera& camera,
                           const render::ViewSettings& settings)
    : renderer_(renderer), world_(std::move(scene)), camera_(camera), settings_(settings) {
  settings_.keep_radiance = true;
}

Result<std::unique_ptr<Accumulation>> Accumulation::start(render::Renderer& renderer, scene::ScenePtr scene,
                                                          const scene::NamedCamera& camera,
                                                          const render::ViewSettings& settings) {
  if (auto valid = render::check(settings); !valid) return valid.error();
  const auto handle = renderer.addWorld(scene);
  if (!handle) return handle.error();
  std::unique_ptr<Accumulation> result(new Accumulation(renderer, std::move(scene), camera, settings));
  result->handle_ = *handle;
  const auto view = renderer.addView(*handle);
  if (!view) return view.error();
  result->view_ = *view;
  return result;
}

Accumulation::~Accumulation() {
  frame_ = {};
  if (view_) renderer_.removeView(view_);
  if (handle_) renderer_.removeWorld(handle_);
}

Result<void> Accumulation::growTo(uint32_t samples, const std::function<void()>& step) {
  while (samples_ < samples) {
    settings_.samples = std::min(kSamplesPerTick, samples - samples_);
    world::ChangeSet changes = world_.beginTick(0);
    changes.environment = camera_.environment;
    const render::ViewRequest request{view_, camera_.camera, settings_};
    auto frames = renderer_.tick(handle_, changes, {&request, 1});
    if (!frames) return frames.error();
    frame_ = std::move(frames->front());
    gpu_ms_ += frame_.stats.gpu_ms;
    rays_ += frame_.stats.rays.total();
    nonfinite_ += frame_.stats.nonfinite;
    samples_ += settings_.samples;
    for (uint32_t i = 0; i < settings_.samples; ++i) step();
  }
  return {};
}

render::ViewSettings referenceSettings(uint32_t width, uint32_t height, uint32_t bounces) {
  render::ViewSettings settings;
  settings.width = width;
  settings.height = height;
  settings.mode = render::Mode::reference;
  settings.bounces = bounces;
  settings.roulette = false;
  settings.auto_exposure = false;
  return settings;
}

}  // namespace helio::bench
