// Lights without extent, round surfaces, and multiple scattering: light that is known in closed form.
#include <gtest/gtest.h>

#include <cmath>

#include "support/scenes.h"
#include "support/stage.h"

namespace helio::test {
namespace {

constexpr float kPi = 3.14159265f;
using scene::PunctualLight;
using Type = PunctualLight::Type;

PunctualLight light(Type type, const glm::vec3& position, float intensity) {
  PunctualLight l;
  l.type = type;
  l.position = position;
  l.direction = {0, -1, 0};
  l.intensity = intensity;
  return l;
}

/// Radiance of a Lambert ground of albedo 0.5 at (x, 0, 0) under `lights`.
glm::vec3 groundUnder(const std::vector<PunctualLight>& lights, float x, const render::ViewSettings& settings) {
  SceneBuilder b;
  b.place(b.prefab("ground", quad(40.0f), b.material(lambert(glm::vec3(0.5f)))));
  scene::Scene scene = *b.build();
  scene.lights = lights;
  Stage stage(std::make_shared<scene::Scene>(scene));
  return mean(stage.accumulate(lookAt({x, 1, 1}, {x, 0, 0}, 0.002f), settings, 32));
}

render::ViewSettings settingsOf(render::Mode mode) {
  render::ViewSettings settings = referenceSettings(16, 16);
  settings.mode = mode;
  settings.roulette = mode == render::Mode::hybrid;
  return settings;
}

// L = albedo / pi I cos / d^2, faded out by the window of the range.
TEST(PunctualLights, PointLight) {
  for (const render::Mode mode : {render::Mode::reference, render::Mode::hybrid}) {
    PunctualLight bulb = light(Type::point, {0, 3, 0}, 40.0f);
    bulb.color = {1.0f, 0.5f, 0.25f};
    const float expected = 0.5f / kPi * 40.0f * 0.6f / 25.0f;  // at 4 m: 5 m away, cosine 3 / 5
    const glm::vec3 seen = groundUnder({bulb}, 4.0f, settingsOf(mode));
    EXPECT_NEAR(seen.x, expected, 2e-3f * expected);
    EXPECT_NEAR(seen.z, 0.25f * expected, 1e-3f * expected);
    bulb.range = 8.0f;
    const float window = 1.0f - std::pow(5.0f / 8.0f, 4.0f);
    EXPECT_NEAR(groundUnder({bulb}, 4.0f, settingsOf(mode)).x, window * expected, 2e-3f * expected);
    bulb.range = 4.0f;
    EXPECT_EQ(groundUnder({bulb}, 4.0f, settingsOf(mode)).x, 0.0f);
  }
}

TEST(PunctualLights, SpotLight) {
  PunctualLight spot = light(Type::spot, {0, 3, 0}, 40.0f);
  spot.inner_cone = 0.5f;
  spot.outer_cone = 1.0f;
  const render::ViewSettings settings = settingsOf(render::Mode::reference);
  // Within the inner cone as a point light; between the cones the squared share; outside nothing.
  const float angle = 0.75f, x = 3.0f * std::tan(angle);
  const auto point = [](float at) { return 0.5f / kPi * 40.0f * 3.0f / std::pow(9.0f + at * at, 1.5f); };
  const float share = (std::cos(angle) - std::cos(1.0f)) / (std::cos(0.5f) - std::cos(1.0f));
  EXPECT_NEAR(groundUnder({spot}, 1.0f, settings).x, point(1.0f), 3e-3f * point(1.0f));
  EXPECT_NEAR(groundUnder({spot}, x, settings).x, share * share * point(x), 5e-3f * point(x));
  EXPECT_EQ(groundUnder({spot}, 6.0f, settings).x, 0.0f);
}

TEST(PunctualLights, DirectionalLight) {
  PunctualLight far = light(Type::directional, {}, 3.0f);
  far.direction = glm::normalize(glm::vec3(1, -1, 0));
  const float expected = 0.5f / kPi * 3.0f * std::sqrt(0.5f);
  for (const render::Mode mode : {render::Mode::reference, render::Mode::hybrid})
    EXPECT_NEAR(groundUnder({far}, 0.0f, settingsOf(mode)).x, expected, 2e-3f * expected);
}

// Lights of all kinds add up, each chosen in turn; without light sampling too, for nothing else finds them.
TEST(PunctualLights, AddUp) {
  const std::vector<PunctualLight> lights{light(Type::point, {1, 2, 0}, 10.0f), light(Type::point, {-6, 1, 2}, 30.0f),
                                          light(Type::spot, {0.2f, 4, 0}, 20.0f), light(Type::directional, {}, 0.5f)};
  render::ViewSettings settings = settingsOf(render::Mode::reference);
  settings.samples = 64;
  float expected = 0.0f;
  for (const PunctualLight& one : lights) expected += groundUnder({one}, 0.0f, settings).x;
  EXPECT_NEAR(groundUnder(lights, 0.0f, settings).x, expected, 0.02f * expected);
  settings.light_sampling = false;
  EXPECT_NEAR(groundUnder(lights, 0.0f, settings).x, expected, 0.02f * expected);
}

// A ball of few facets under a low sun: its facets put no texel into shadow that lies in light on a ball of many.
TEST(RoundSurfaces, FacetsDoNotShadeEachOther) {
  constexpr uint32_t kSize = 96;
  const auto picture = [](uint32_t rings, bool round) {
    SceneBuilder b;
    b.place(b.prefab("ball", sphere(rings), b.material(lambert(glm::vec3(0.8f)))));
    b.environment().sun = {glm::normalize(glm::vec3(-1, -0.2f, 0)), glm::vec3(3.0f), 0.0093f};
    Stage stage(b.build());
    render::ViewSettings settings = referenceSettings(kSize, kSize);
    settings.bounces = 0;
    settings.round_surfaces = round;
    const render::Frame frame = stage.accumulate(lookAt({0, 0, 4}, {0, 0, 0}, 0.45f), settings, 16);
    showPicture(frame, "ball_" + std::to_string(rings) + (round ? "_round" : "_flat"));
    return frame;
  };
  const render::Frame truth = picture(64, true);
  const auto wrongly_dark = [&](const render::Frame& seen) {
    uint32_t count = 0;
    for (uint32_t y = 0; y < kSize; ++y)
      for (uint32_t x = 0; x < kSize; ++x) {
        const bool inside = glm::distance(glm::vec2(x, y), glm::vec2(0.5f * kSize)) < 44.0f;  // of the coarse ball
        count += inside && texel(truth, x, y).x > 0.03f && texel(seen, x, y).x < 0.5f * texel(truth, x, y).x;
      }
    return count;
  };
  EXPECT_GT(wrongly_dark(picture(10, false)), 50u);
  EXPECT_EQ(wrongly_dark(picture(10, true)), 0u);
}

/// Mean over the middle of a metal ball of reflectance 1 in a sky of radiance 1.
float furnace(float roughness, bool multiple_scattering) {
  SceneBuilder b;
  b.place(b.prefab("ball", sphere(48), b.material(metal(glm::vec3(1.0f), roughness))));
  b.environment().sky = {glm::vec3(1.0f), glm::vec3(1.0f)};
  Stage stage(b.build());
  render::ViewSettings settings = referenceSettings(32, 32);
  settings.multiple_scattering = multiple_scattering;
  return mean(stage.accumulate(lookAt({0, 0, 4}, {0, 0, 0}, 0.35f), settings, 64)).x;
}

TEST(MultipleScattering, LosesNoLight) {
  for (const float roughness : {0.1f, 0.3f, 0.5f, 0.7f, 0.85f, 1.0f})
    EXPECT_NEAR(furnace(roughness, true), 1.0f, 0.01f) << "roughness " << roughness;
  EXPECT_LT(furnace(1.0f, false), 0.6f) << "a single scattering must lose light, or this test proves nothing";
}

}  // namespace
}  // namespace helio::test
