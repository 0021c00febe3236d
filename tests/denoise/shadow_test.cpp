// Shadows of the sun behind a denoiser: small ones stay, and those that move are where they are, not where they were.
#include <cstdio>

#include "denoise/pictures.h"

namespace helio::test {
namespace {

using render::Denoiser;

const scene::Camera kAbove = lookAt({0.0f, 2.2f, 0.01f}, {0.0f, 0.0f, 0.0f});
constexpr world::InstanceId kCaster = 2;
constexpr float kFarAside = 30.0f;

/// A floor under the sun and a lamp whose light is noisy, since a hundred others far off are drawn as often; the
/// instance kCaster is a cube of `side` metres that floats out of sight and throws its shadow on the floor.
scene::ScenePtr floorUnderTheSun(float side) {
  SceneBuilder b;
  b.place(b.prefab("floor", quad(30.0f), b.material(lambert(glm::vec3(0.6f)))));
  b.place(b.prefab("caster", cube(), b.material(lambert(glm::vec3(0.5f)))), at({kFarAside, 0.5f, 0.0f}, side));
  const uint32_t lamp = b.prefab("lamp", sphere(4), b.material(lambert(glm::vec3(0.3f), glm::vec3(40.0f))));
  b.place(lamp, at({-1.5f, 2.5f, 2.5f}, 0.1f));
  for (int i = 0; i < 100; ++i) b.place(lamp, at({200.0f + static_cast<float>(i), 2.0f, 200.0f}, 0.1f));
  b.environment().sun = {glm::normalize(glm::vec3(0.3f, -1.0f, -0.2f)), glm::vec3(3.0f), 0.0093f};
  b.environment().sky = {glm::vec3(0.05f), glm::vec3(0.05f)};
  return b.build();
}

void moveTo(Stage& stage, float x, float side) {
  stage.edit({world::Move{kCaster, {glm::vec3(x, 0.5f, 0.0f), glm::quat(1, 0, 0, 0), side}}});
}

double luma(const render::Frame& frame, size_t pixel) {
  return 0.2126 * static_cast<double>(frame.radiance[3 * pixel]) +
         0.7152 * static_cast<double>(frame.radiance[3 * pixel + 1]) +
         0.0722 * static_cast<double>(frame.radiance[3 * pixel + 2]);
}

/// Mean luminance of `shown` over that of `expected`, where `expected` is darker or brighter than `light` times its
/// brightest.
struct Shares {
  double in_shadow = 0.0, in_light = 0.0;
  size_t shadow_pixels = 0;
};
Shares compare(const render::Frame& shown, const render::Frame& expected, double light = 0.5) {
  double brightest = 0.0, found[2] = {}, truth[2] = {};
  const size_t pixels = expected.radiance.size() / 3;
  for (size_t i = 0; i < pixels; ++i) brightest = std::max(brightest, luma(expected, i));
  Shares shares;
  for (size_t i = 0; i < pixels; ++i) {
    const bool lit = luma(expected, i) > light * brightest;
    shares.shadow_pixels += !lit;
    found[lit] += luma(shown, i);
    truth[lit] += luma(expected, i);
  }
  shares.in_shadow = found[0] / truth[0];
  shares.in_light = found[1] / truth[1];
  return shares;
}

/// A wall in the sun with ledges as white, whose shadows below them are about a pixel high.
scene::ScenePtr wallWithLedges() {
  SceneBuilder b;
  const uint32_t plaster = b.material(lambert(glm::vec3(0.8f)));
  b.place(b.prefab("wall", cube(), plaster), glm::mat4x3({6.0f, 0, 0}, {0, 6.0f, 0}, {0, 0, 0.1f}, {0, 0, -0.05f}));
  const uint32_t ledge = b.prefab("ledge", cube(), plaster);
  for (int i = -3; i <= 3; ++i) {
    const float tilt = 0.03f * static_cast<float>(i + 4);  // edges pass the pixels at all heights
    b.place(ledge,
            glm::mat4x3({3.0f, tilt, 0}, {0, 0.05f, 0}, {0, 0, 0.08f}, {0, 0.3f * static_cast<float>(i), 0.04f}));
  }
  b.environment().sun = {glm::normalize(glm::vec3(0.2f, -1.0f, -1.0f)), glm::vec3(6.0f), 0.0093f};
  b.environment().sky = {glm::vec3(0.15f), glm::vec3(0.15f)};
  return b.build();
}

class Shadows : public testing::TestWithParam<Denoiser> {};

TEST_P(Shadows, OfSmallThingsStay) {
  constexpr float kSide = 0.2f;  // some four pixels
  Stage reference(floorUnderTheSun(kSide)), stage(floorUnderTheSun(kSide));
  moveTo(reference, 0.0f, kSide);
  moveTo(stage, 0.0f, kSide);
  render::ViewSettings settings = live(Denoiser::none);
  settings.accumulate = true;
  settings.samples = 16;
  const render::Frame expected = reference.accumulate(kAbove, settings, 16);
  const Shares shares = compare(stage.accumulate(kAbove, live(GetParam()), 8), expected);
  std::printf("%zu pixels of shadow have %.2f of their light, the others %.3f\n", shares.shadow_pixels,
              shares.in_shadow, shares.in_light);
  EXPECT_GT(shares.shadow_pixels, 5u);
  EXPECT_LT(shares.in_shadow, 1.6);
  EXPECT_NEAR(shares.in_light, 1.0, 0.05);
}

TEST_P(Shadows, ThatMoveAreThereAtOnceAndLeaveNothing) {
  constexpr float kSide = 0.7f, kFrom = -0.8f, kTo = 0.8f;  // metres: it leaves its shadow behind
  Stage reference(floorUnderTheSun(kSide)), stage(floorUnderTheSun(kSide));
  moveTo(reference, kTo, kSide);
  moveTo(stage, kFrom, kSide);
  render::ViewSettings settings = live(Denoiser::none);
  settings.accumulate = true;
  settings.samples = 16;
  const render::Frame expected = reference.accumulate(kAbove, settings, 16);
  stage.accumulate(kAbove, live(GetParam()), 16);
  moveTo(stage, kTo, kSide);
  const Shares shares = compare(stage.tick(kAbove, live(GetParam())), expected);
  std::printf("%zu pixels of shadow have %.2f of their light, the others %.3f\n", shares.shadow_pixels,
              shares.in_shadow, shares.in_light);
  EXPECT_GT(shares.shadow_pixels, 50u);
  EXPECT_LT(shares.in_shadow, 1.6);
  EXPECT_NEAR(shares.in_light, 1.0, 0.0125);
}

// With anti-aliasing a pixel shows in turns a ledge and the shade below it, which has its history beside it: not in the
// sun.
TEST_P(Shadows, BesideTheSunStayDarkAtRest) {
  const scene::Camera camera = lookAt({0.3f, 0.4f, 3.0f}, {0, 0, 0});
  const scene::ScenePtr scene = wallWithLedges();
  const render::Frame expected = truth(scene, camera);
  render::ViewSettings settings = live(GetParam());
  settings.taa = true;
  Stage stage(scene);
  const render::Frame shown = stage.accumulate(camera, settings, 32);
  const Shares shares = compare(shown, expected, 0.4);
  std::printf("%zu pixels of shadow have %.3f of their light, the others %.3f\n", shares.shadow_pixels,
              shares.in_shadow, shares.in_light);
  showPicture(shown, "ledges");
  showPicture(expected, "ledges_truth");
  EXPECT_GT(shares.shadow_pixels, 500u);
  // Ticks that miss a line of shade cut it from the picture; light taken from beside would add a tenth and more.
  EXPECT_LT(shares.in_shadow, GetParam() == Denoiser::reblur ? 1.45 : 1.25);
  EXPECT_NEAR(shares.in_light, 1.0, 0.05);
}

// Of a sun as wide as a hand at arm's length: what noise there is lies in the penumbra.
TEST_P(Shadows, OfAWideSunAreSmoothFromTheFirstTick) {
  SceneBuilder b;
  b.place(b.prefab("floor", quad(30.0f), b.material(lambert(glm::vec3(0.6f)))));
  b.place(b.prefab("caster", cube(), b.material(lambert(glm::vec3(0.5f)))), at({0.9f, 1.0f, 0.0f}, 0.8f));
  b.environment().sun = {glm::normalize(glm::vec3(-0.7f, -1.0f, 0.1f)), glm::vec3(3.0f), 0.3f};
  b.environment().sky = {glm::vec3(0.02f), glm::vec3(0.02f)};
  const scene::ScenePtr scene = b.build();
  const render::Frame expected = truth(scene, kAbove);
  Stage raw(scene), stage(scene);
  const double noise = relativeMse(raw.tick(kAbove, live(Denoiser::none)), expected);
  for (int tick = 1; tick <= 16; ++tick) {
    const render::Frame shown = stage.tick(kAbove, live(GetParam()));
    if (tick != 1 && tick != 16) continue;
    const double error = relativeMse(shown, expected);
    std::printf("tick %d: relative MSE %.5f of %.4f (1/%.1f)\n", tick, error, noise, noise / error);
    showPicture(shown, "wide_sun_" + std::to_string(tick));
    EXPECT_LT(error, noise / (tick == 1 ? 10.0 : 60.0));
    EXPECT_NEAR(mean(shown).y / mean(expected).y, 1.0f, 0.02f);
  }
}

INSTANTIATE_TEST_SUITE_P(Denoise, Shadows, testing::Values(Denoiser::svgf, Denoiser::asvgf, Denoiser::reblur),
                         [](const auto& info) {
                           return info.param == Denoiser::svgf    ? "svgf"
                                  : info.param == Denoiser::asvgf ? "asvgf"
                                                                  : "reblur";
                         });

}  // namespace
}  // namespace helio::test
