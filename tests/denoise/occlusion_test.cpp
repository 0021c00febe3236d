// Ambient occlusion behind a denoiser has a filter of its own.
#include <cstdio>

#include "denoise/pictures.h"

namespace helio::test {
namespace {

using render::Ambient;
using render::Denoiser;

const scene::Camera kCamera = lookAt({0.8f, 2.0f, 3.2f}, {0, 0.3f, 0});
constexpr world::InstanceId kBox = 2;

/// A box and a ball on a floor, under a sky alone.
scene::ScenePtr underTheSky() {
  SceneBuilder b;
  scene::Material coated;
  coated.base_color = {0.5f, 0.3f, 0.2f, 1.0f};
  coated.roughness = 0.9f;
  b.place(b.prefab("floor", quad(30.0f), b.material(lambert({0.6f, 0.6f, 0.5f}))));
  b.place(b.prefab("box", cube(), b.material(lambert({0.3f, 0.5f, 0.7f}))), at({-0.6f, 0.5f, 0.0f}));
  b.place(b.prefab("ball", sphere(24), b.material(coated)), at({0.6f, 0.5f, 0.2f}, 0.5f));
  b.environment().sky = {{0.8f, 0.9f, 1.0f}, {0.5f, 0.5f, 0.5f}};
  return b.build();
}

render::ViewSettings occluded(Denoiser denoiser) {
  render::ViewSettings settings = live(denoiser, render::Primary::raster);  // all samples see the same points
  settings.technique = render::Technique::distributed;
  settings.ambient = Ambient::occluded;
  settings.ambient_radius = 2.0f;
  return settings;
}

render::Frame converged(const scene::ScenePtr& scene) {
  Stage stage(scene);
  render::ViewSettings settings = occluded(Denoiser::none);
  settings.samples = 64;
  return stage.tick(kCamera, settings);
}

class Occlusion : public testing::TestWithParam<Denoiser> {};

TEST_P(Occlusion, IsNearTheTruthFromTheFirstTick) {
  const scene::ScenePtr scene = underTheSky();
  const render::Frame expected = converged(scene);
  Stage raw(scene), stage(scene);
  const double noise = relativeMse(raw.tick(kCamera, occluded(Denoiser::none)), expected);
  for (int tick = 1; tick <= 16; ++tick) {
    const render::Frame shown = stage.tick(kCamera, occluded(GetParam()));
    EXPECT_EQ(brokenTexels(shown), 0u);
    if (tick != 1 && tick != 16) continue;
    const double error = relativeMse(shown, expected);
    std::printf("tick %d: relative MSE %.5f of %.4f (1/%.0f), %.1f MB\n", tick, error, noise, noise / error,
                historyMegabytes(shown));
    showPicture(shown, "occlusion_" + std::to_string(tick));
    EXPECT_LT(error, noise / (tick == 1 ? 20.0 : 50.0)) << "tick " << tick;
    EXPECT_NEAR(mean(shown).y / mean(expected).y, 1.0f, 0.02f) << "tick " << tick;
    EXPECT_TRUE(recorded(shown, "occlusion"));
  }
  showPicture(expected, "occlusion_truth");
}

TEST_P(Occlusion, LeavesWithWhatOccluded) {
  const scene::ScenePtr scene = underTheSky();
  Stage stage(scene), empty(scene);
  const auto remove = [](Stage& s) { s.edit({world::Destroy{{kBox}}}); };
  remove(empty);
  render::ViewSettings settings = occluded(Denoiser::none);
  settings.samples = 64;
  const render::Frame expected = empty.tick(kCamera, settings);
  const render::Frame before = stage.accumulate(kCamera, occluded(GetParam()), 24);
  EXPECT_GT(relativeMse(before, expected), 0.02);
  remove(stage);
  const render::Frame shown = stage.accumulate(kCamera, occluded(GetParam()), 4);
  std::printf("before %.4f, four ticks later %.5f\n", relativeMse(before, expected), relativeMse(shown, expected));
  showPicture(shown, "occlusion_left");
  EXPECT_LT(relativeMse(shown, expected), 0.01);
}

TEST_P(Occlusion, TakesMemoryOnlyWhereItIsAskedFor) {
  Stage stage(underTheSky());
  render::ViewSettings settings = occluded(GetParam());
  const double with = historyMegabytes(stage.tick(kCamera, settings));
  settings.ambient = Ambient::constant;
  const render::Frame frame = stage.tick(kCamera, settings);
  EXPECT_FALSE(recorded(frame, "occlusion"));
  EXPECT_NEAR(with - historyMegabytes(frame), 3 * 2 * 1920 * 1080 * 1e-6, 0.01);
}

// Open to the sky it has no noise, and nothing that a filter could blur.
TEST_P(Occlusion, ConstantAmbientLightIsExact) {
  const scene::ScenePtr scene = underTheSky();
  Stage plain(scene), stage(scene);
  render::ViewSettings settings = occluded(Denoiser::none);
  settings.ambient = Ambient::constant;
  settings.bounces = 0;
  settings.samples = 64;
  const render::Frame expected = plain.tick(kCamera, settings);
  settings.denoiser = GetParam();
  settings.samples = 1;
  EXPECT_LT(relativeMse(stage.tick(kCamera, settings), expected), 1e-3);
}

INSTANTIATE_TEST_SUITE_P(Denoise, Occlusion, testing::Values(Denoiser::svgf, Denoiser::asvgf, Denoiser::reblur),
                         [](const auto& info) {
                           return info.param == Denoiser::svgf    ? "svgf"
                                  : info.param == Denoiser::asvgf ? "asvgf"
                                                                  : "reblur";
                         });

}  // namespace
}  // namespace helio::test
