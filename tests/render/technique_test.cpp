// Whitted's and distributed ray tracing, ambient light and the lens, held to closed forms.
#include <algorithm>
#include <cmath>
#include <functional>

#include "support/scenes.h"
#include "support/stage.h"

namespace helio::test {
namespace {

using glm::vec3;
using render::Ambient;
using render::Denoiser;
using render::Primary;
using render::Technique;

constexpr float kPi = 3.14159265f;

/// One sample a pixel in fixed exposure, traced, without an average over ticks.
render::ViewSettings live(Technique technique) {
  render::ViewSettings settings;
  settings.width = 64;
  settings.height = 36;
  settings.primary = Primary::traced;
  settings.technique = technique;
  settings.auto_exposure = false;
  settings.keep_radiance = true;
  settings.accumulate = false;
  return settings;
}

const scene::Camera kDown = lookAt({0, 2, 0}, {0, 0, 0}, 0.05f);

TEST(Whitted, FramesOfOneMomentAreTheSameToTheBit) {
  for (const scene::ScenePtr& scene : {stillLife(), lampRoom(), sunlitPatch()})
    for (const Primary primary : {Primary::raster, Primary::traced}) {
      const scene::Camera camera = lookAt({0.4f, 1.6f, 4.2f}, {0, 0.6f, 0});
      render::ViewSettings settings = live(Technique::whitted);
      settings.primary = primary;
      settings.ambient = Ambient::constant;
      Stage young(scene), old(scene), averaged(scene);
      for (Stage* stage : {&young, &old, &averaged}) stage->setStep(0.0);
      const render::Frame first = young.tick(camera, settings), later = old.accumulate(camera, settings, 4);
      EXPECT_EQ(first.radiance, later.radiance);
      EXPECT_EQ(bytes(first), bytes(later));
      EXPECT_GT(mean(first).y, 0.01f);
      // Nor does an average over ticks change it: there is nothing to average.
      settings.accumulate = true;
      EXPECT_EQ(averaged.accumulate(camera, settings, 3).radiance, first.radiance);
      showPicture(first, "whitted");
    }
}

/// A grey ground of albedo 0.5, and what `add` puts beside it.
scene::ScenePtr ground(const std::function<void(SceneBuilder&)>& add) {
  SceneBuilder b;
  b.place(b.prefab("ground", quad(100.0f), b.material(lambert(vec3(0.5f)))));
  add(b);
  return b.build();
}

float middle(const scene::ScenePtr& scene, const render::ViewSettings& settings, const scene::Camera& camera = kDown) {
  Stage stage(scene);
  return mean(stage.tick(camera, settings)).y;
}

TEST(Whitted, LightComesFromTheMiddleOfLamps) {
  const render::ViewSettings settings = live(Technique::whitted);
  // A ball of radius r and radiance L has the intensity pi r^2 L to all sides.
  const auto ball = ground([](SceneBuilder& b) {
    b.place(b.prefab("ball", sphere(24), b.material(lambert(vec3(0.0f), vec3(50.0f)))), at({0, 5, 0}, 0.2f));
  });
  EXPECT_NEAR(middle(ball, settings) / (0.5f / kPi * 50.0f * kPi * 0.04f / 25.0f), 1.0f, 0.02f);
  // A plane of area A has A L cos.
  const auto panel = ground([](SceneBuilder& b) {
    b.place(b.prefab("panel", quad(0.4f), b.material(lambert(vec3(0.0f), vec3(50.0f)))), at({4, 3, 0}));
  });
  const float cosine = 0.6f, area = 0.16f;  // 5 m away
  EXPECT_NEAR(middle(panel, settings) / (0.5f / kPi * 50.0f * area * cosine * cosine / 25.0f), 1.0f, 0.02f);
  const auto sun = ground([](SceneBuilder& b) {
    b.environment().sun = {glm::normalize(vec3(1, -1, 0)), vec3(3.0f), 0.3f};
  });
  EXPECT_NEAR(middle(sun, settings) / (0.5f / kPi * 3.0f * std::sqrt(0.5f)), 1.0f, 0.01f);
}

TEST(Whitted, ShadowsAreHardAndSoftOnesAreDistributed) {
  const auto scene = ground([](SceneBuilder& b) {
    b.place(b.prefab("box", cube(), b.material(lambert(vec3(0.0f)))), at({0.3f, 3.0f, 0}));
    b.environment().sun = {vec3(0, -1, 0), vec3(kPi), 0.3f};
  });
  const scene::Camera below = lookAt({0, 1.5f, 0}, {0, 0, 0}, 1.2f);
  const auto partly = [&](Technique technique) {
    Stage stage(scene);
    render::ViewSettings settings = live(technique);
    if (technique != Technique::whitted) settings.samples = 64;
    const render::Frame frame = stage.tick(below, settings);
    size_t count = 0;
    for (const float value : frame.radiance) count += value > 0.02f && value < 0.48f;
    EXPECT_GT(*std::max_element(frame.radiance.begin(), frame.radiance.end()), 0.48f);
    EXPECT_LT(*std::min_element(frame.radiance.begin(), frame.radiance.end()), 0.02f);
    return count;
  };
  EXPECT_EQ(partly(Technique::whitted), 0u);
  EXPECT_GT(partly(Technique::distributed), 200u);
}

TEST(Whitted, MirrorsShowWhatIsBehindThem) {
  SceneBuilder b;
  b.place(b.prefab("mirror", quad(4.0f), b.material(metal(vec3(0.8f), 0.0f))));
  b.place(b.prefab("panel", quad(4.0f), b.material(lambert(vec3(0.0f), vec3(2.0f)))), at({0, 3, 0}));
  const auto scene = b.build();
  EXPECT_NEAR(middle(scene, live(Technique::whitted)), 1.6f, 0.01f);
  EXPECT_NEAR(middle(scene, live(Technique::distributed)), 1.6f, 0.1f);
}

// The sky's gradient over a plane: its cosine-weighted mean height is two thirds.
TEST(Ambient, IsTheOpenSkysLight) {
  const auto scene = ground([](SceneBuilder& b) { b.environment().sky = {vec3(1.0f), vec3(0.4f)}; });
  const float open = 0.5f * (0.4f + (1.0f - 0.4f) * (0.5f + 1.0f / 3.0f));
  for (const Technique technique : {Technique::whitted, Technique::distributed}) {
    render::ViewSettings settings = live(technique);
    EXPECT_EQ(middle(scene, settings), 0.0f);
    settings.ambient = Ambient::constant;
    EXPECT_NEAR(middle(scene, settings), open, 1e-4f);
  }
  render::ViewSettings settings = live(Technique::distributed);
  settings.ambient = Ambient::occluded;
  settings.samples = 64;
  EXPECT_NEAR(middle(scene, settings), open, 0.002f);
}

// Under a ceiling at height h rays of length R get away where cos < h / R: of the cosine-weighted ones (h / R)^2.
TEST(Ambient, OccludersCountWithinTheRadius) {
  const auto scene = ground([](SceneBuilder& b) {
    b.place(b.prefab("ceiling", quad(100.0f), b.material(lambert(vec3(0.0f)))), at({0, 3, 0}));
    b.environment().sky = {vec3(1.0f), vec3(1.0f)};
  });
  render::ViewSettings settings = live(Technique::distributed);
  settings.ambient = Ambient::occluded;
  settings.samples = 64;
  for (const float radius : {1.0f, 4.0f, 6.0f, 12.0f}) {
    settings.ambient_radius = radius;
    const float seen = radius < 3.0f ? 1.0f : 9.0f / (radius * radius);
    EXPECT_NEAR(middle(scene, settings), 0.5f * seen, 0.004f) << radius << " m";
  }
}

/// Mean square distance from the picture's middle along x of all light, metres at the distance d, and the light's sum.
struct Spread {
  double variance = 0.0, sum = 0.0;
};
Spread spreadOf(float aperture, float focus) {
  constexpr float kDistance = 4.0f;
  SceneBuilder b;
  b.place(b.prefab("light", quad(0.2f), b.material(lambert(vec3(0.0f), vec3(10.0f)))), at({0, -kDistance, 0}));
  Stage stage(b.build());
  render::ViewSettings settings = live(Technique::path_traced);
  settings.mode = render::Mode::reference;
  settings.samples = 64;
  settings.height = settings.width;
  settings.aperture = aperture;
  settings.focus = focus;
  const render::Frame frame = stage.accumulate(lookAt({0, 0, 0}, {0, -1, 0}, 0.5f), settings, 4);
  Spread spread;
  const double metres = 2.0 * std::tan(0.25) * kDistance / settings.width;
  for (uint32_t y = 0; y < settings.height; ++y)
    for (uint32_t x = 0; x < settings.width; ++x) {
      const double light = texel(frame, x, y).y, away = (x + 0.5 - 0.5 * settings.width) * metres;
      spread.sum += light;
      spread.variance += light * away * away;
    }
  spread.variance /= spread.sum;
  showPicture(frame, "lens_" + std::to_string(aperture) + "_" + std::to_string(focus));
  return spread;
}

// A point's light covers a disc of diameter c = A |d - f| / f at its distance, whose variance along an axis is c^2 /
// 16; the light's own is its width squared over 12.
TEST(Lens, SpreadsWhatIsNotInFocus) {
  const Spread sharp = spreadOf(0.0f, 4.0f);
  EXPECT_NEAR(sharp.variance, 0.04 / 12.0, 0.0003);
  const Spread focused = spreadOf(0.4f, 4.0f);
  EXPECT_NEAR(focused.variance, sharp.variance, 0.0002);
  EXPECT_NEAR(focused.sum / sharp.sum, 1.0, 0.02);
  for (const float focus : {2.5f, 8.0f}) {
    const Spread blurred = spreadOf(0.4f, focus);
    const double disc = 0.4 * std::abs(4.0 - focus) / focus;
    EXPECT_NEAR((blurred.variance - sharp.variance) / (disc * disc / 16.0), 1.0, 0.05) << "focus " << focus;
    EXPECT_NEAR(blurred.sum / sharp.sum, 1.0, 0.02);
  }
}

TEST(Technique, WhatCannotBeIsRefusedByName) {
  struct Case {
    const char* field;
    std::function<void(render::ViewSettings&)> change;
  };
  const std::vector<Case> cases = {
      {"settings.ambient", [](auto& s) { s.ambient = Ambient::constant; }},
      {"settings.ambient", [](auto& s) { s.technique = Technique::whitted, s.ambient = Ambient::occluded; }},
      {"settings.ambient_radius", [](auto& s) { s.ambient_radius = 0.0f; }},
      {"settings.denoiser", [](auto& s) { s.technique = Technique::whitted, s.denoiser = Denoiser::svgf; }},
      {"settings.aperture", [](auto& s) { s.technique = Technique::whitted, s.aperture = 0.1f; }},
      {"settings.aperture", [](auto& s) { s.primary = Primary::raster, s.aperture = 0.1f; }},
      {"settings.aperture", [](auto& s) { s.aperture = -1.0f; }},
      {"settings.focus", [](auto& s) { s.focus = 0.0f; }},
      {"settings.light_feedback", [](auto& s) { s.technique = Technique::whitted, s.light_feedback = true; }},
      {"settings.light_feedback", [](auto& s) { s.light_lists = false, s.light_feedback = true; }},
      {"settings.light_sampling", [](auto& s) { s.technique = Technique::distributed, s.light_sampling = false; }},
      {"settings.indirect_rate",
       [](auto& s) { s.technique = Technique::distributed, s.indirect_rate = render::IndirectRate::half; }},
      {"settings.samples", [](auto& s) { s.samples = 2, s.indirect_rate = render::IndirectRate::half; }},
      {"settings.denoiser",
       [](auto& s) { s.denoiser = Denoiser::asvgf, s.indirect_rate = render::IndirectRate::half; }},
  };
  EXPECT_TRUE(render::check(live(Technique::path_traced)));
  for (const Case& each : cases) {
    render::ViewSettings settings = live(Technique::path_traced);
    each.change(settings);
    const auto valid = render::check(settings);
    ASSERT_FALSE(valid) << each.field;
    EXPECT_EQ(valid.error().field, each.field) << valid.error().message;
  }
}

}  // namespace
}  // namespace helio::test
