#include "bench/accumulation.h"

#include <algorithm>

namespace helio::bench {
namespace {

constexpr uint32_t kSamplesPerTick = 4;  // so that progress is seen

}  // namespace

Accumulation::Accumulation(std::unique_ptr<test::ViewedWorld> viewed, const scene::Camera& camera,
                           const render::ViewSettings& settings)
    : viewed_(std::move(viewed)), camera_(camera), settings_(settings) {
  settings_.keep_radiance = true;
}

Result<std::unique_ptr<Accumulation>> Accumulation::start(render::Renderer& renderer, scene::ScenePtr scene,
                                                          const scene::NamedCamera& camera,
                                                          const render::ViewSettings& settings) {
  if (auto valid = render::check(settings); !valid) return valid.error();
  auto viewed = test::ViewedWorld::open(renderer, std::move(scene));
  if (!viewed) return viewed.error();
  if (auto lit = (*viewed)->setLight(camera.environment); !lit) return lit.error();
  return std::unique_ptr<Accumulation>(new Accumulation(std::move(*viewed), camera.camera, settings));
}

Result<void> Accumulation::growTo(uint32_t samples, const std::function<void()>& step) {
  while (samples_ < samples) {
    settings_.samples = std::min(kSamplesPerTick, samples - samples_);
    auto frame = viewed_->tick(camera_, settings_, 0.0);
    if (!frame) return frame.error();
    frame_ = std::move(*frame);
    gpu_ms_ += frame_.stats.gpu_ms;
    rays_ += frame_.stats.rays.total();
    nonfinite_ += frame_.stats.nonfinite;
    samples_ += settings_.samples;
    for (uint32_t i = 0; i < settings_.samples; ++i) step();
  }
  return {};
}

render::ViewSettings referenceSettings(uint32_t width, uint32_t height, uint32_t bounces) {
  render::ViewSettings settings = test::referenceSettings(width, height);
  settings.bounces = bounces;
  settings.roulette = false;
  return settings;
}

render::ViewSettings specSettings(const scene::Spec& spec) {
  render::ViewSettings settings = referenceSettings(spec.width, spec.height, spec.bounces);
  if (spec.lambert) settings.materials = render::MaterialOverride::lambert;
  return settings;
}

}  // namespace helio::bench
