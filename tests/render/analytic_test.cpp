// Scenes whose radiance is known in closed form [correctness: analytic scenes].
#include <cmath>

#include "support/scenes.h"
#include "support/stage.h"

namespace helio::test {
namespace {

using render::Mode;
using render::Primary;

constexpr float kPi = 3.14159265f;

/// Every way to the same picture.
struct Integrator {
  const char* name;
  Mode mode;
  Primary primary;
};
constexpr Integrator kIntegrators[] = {{"reference", Mode::reference, Primary::traced},
                                       {"hybrid, traced", Mode::hybrid, Primary::traced},
                                       {"hybrid, rasterised", Mode::hybrid, Primary::raster}};

render::ViewSettings settingsOf(const Integrator& integrator) {
  render::ViewSettings settings = referenceSettings();
  settings.mode = integrator.mode;
  settings.primary = integrator.primary;
  return settings;
}

// L = albedo E cos / pi.
TEST(Analytic, PlaneUnderTiltedSun) {
  const float elevation = 1.0472f;  // 60 degrees
  SceneBuilder b;
  b.place(b.prefab("plane", quad(1000.0f), b.material(lambert(glm::vec3(0.8f)))));
  b.environment().sun = {{std::cos(elevation), -std::sin(elevation), 0.0f}, glm::vec3(kPi), 0.0093f};
  Stage stage(b.build());
  for (const Integrator& integrator : kIntegrators) {
    const render::Frame frame = stage.accumulate(lookAt({0, 10, 0}, {0, 0, 0}), settingsOf(integrator), 4);
    const glm::vec3 expected(0.8f * std::sin(elevation));
    EXPECT_NEAR(mean(frame).x, expected.x, 0.002f * expected.x) << integrator.name;
    EXPECT_EQ(frame.stats.nonfinite, 0u);
  }
}

// Under a uniform sky of radiance 1 a Lambert surface of albedo a shows a.
TEST(Analytic, PlaneUnderUniformSky) {
  SceneBuilder b;
  b.place(b.prefab("plane", quad(1000.0f), b.material(lambert({0.8f, 0.5f, 0.2f}))));
  b.environment().sky = {glm::vec3(1.0f), glm::vec3(1.0f)};
  Stage stage(b.build());
  for (const Integrator& integrator : kIntegrators) {
    const glm::vec3 seen = mean(stage.accumulate(lookAt({0, 10, 0}, {0, 0, 0}), settingsOf(integrator), 4));
    EXPECT_NEAR(seen.x, 0.8f, 0.002f) << integrator.name;
    EXPECT_NEAR(seen.y, 0.5f, 0.002f) << integrator.name;
    EXPECT_NEAR(seen.z, 0.2f, 0.002f) << integrator.name;
  }
}

// The gradient seen by the camera, and on a horizontal plane: E / pi = mean over the cosine hemisphere.
TEST(Analytic, GradientSky) {
  const glm::vec3 zenith(2.0f, 1.0f, 0.5f), ground(0.2f);
  SceneBuilder b;
  b.place(b.prefab("plane", quad(1000.0f), b.material(lambert(glm::vec3(1.0f)))));
  b.environment().sky = {zenith, ground};
  Stage stage(b.build());
  render::ViewSettings settings = referenceSettings();
  settings.roulette = false;
  // The mean of y over the cosine-weighted hemisphere is 2/3.
  const glm::vec3 expected = glm::mix(ground, zenith, 0.5f + 0.5f * 2.0f / 3.0f);
  const glm::vec3 seen = mean(stage.accumulate(lookAt({0, 10, 0}, {0, 0, 0}), settings, 64));
  EXPECT_NEAR(seen.x, expected.x, 0.005f * expected.x);
  EXPECT_NEAR(seen.z, expected.z, 0.005f * expected.z);

  const glm::vec3 up = texel(stage.accumulate(lookAt({0, 10, 0}, {0, 20, 0}, 0.01f), settings, 1), 32, 32);
  EXPECT_NEAR(up.x, zenith.x, 1e-3f);
}

// A Lambert sphere of albedo 1 in a sky of radiance 1 cannot be told from the sky.
TEST(Analytic, WhiteFurnaceSphere) {
  SceneBuilder b;
  b.place(b.prefab("sphere", sphere(64), b.material(lambert(glm::vec3(1.0f)))));
  b.environment().sky = {glm::vec3(1.0f), glm::vec3(1.0f)};
  Stage stage(b.build());
  for (const Integrator& integrator : kIntegrators) {
    render::ViewSettings settings = settingsOf(integrator);
    settings.bounces = 16;
    const render::Frame frame = stage.accumulate(lookAt({0, 0, 4}, {0, 0, 0}, 0.6f), settings, 64);
    EXPECT_NEAR(mean(frame).x, 1.0f, 0.005f) << integrator.name;
    EXPECT_EQ(frame.stats.nonfinite, 0u);
    showPicture(frame, std::string("furnace_") + integrator.name);
  }
}

// Inside a closed box that shines with Le and reflects rho: L = Le sum_{k <= B + 1} rho^k.
TEST(Analytic, ClosedShiningBox) {
  const float emission = 0.5f, albedo = 0.7f;
  SceneBuilder b;
  b.place(b.prefab("box", cube(), b.material(lambert(glm::vec3(albedo), glm::vec3(emission)))), at({0, 0, 0}, 4.0f));
  Stage stage(b.build());
  for (const uint32_t bounces : {0u, 3u}) {
    float expected = 0.0f;
    for (uint32_t k = 0; k <= bounces + 1; ++k) expected += emission * std::pow(albedo, static_cast<float>(k));
    for (const Integrator& integrator : kIntegrators) {
      render::ViewSettings settings = settingsOf(integrator);
      settings.bounces = bounces;
      const glm::vec3 seen = mean(stage.accumulate(lookAt({0, 0, 0}, {1, 0.3f, 0.2f}, 1.2f), settings, 64));
      EXPECT_NEAR(seen.x, expected, 0.01f * expected) << integrator.name << ", " << bounces << " bounces";
    }
  }
}

// A mirror shows the sky's gradient in the mirrored direction, times its colour (F = 1 at no angle but grazing).
TEST(Analytic, MirrorShowsTheSky) {
  SceneBuilder b;
  b.place(b.prefab("mirror", quad(100.0f), b.material(metal(glm::vec3(1.0f), 0.0f))));
  b.environment().sky = {glm::vec3(2.0f), glm::vec3(0.0f)};
  Stage stage(b.build());
  const scene::Camera camera = lookAt({0, 5, 0}, {0, 0, -5}, 0.01f);
  const float y = std::sqrt(0.5f);
  for (const Integrator& integrator : kIntegrators)
    EXPECT_NEAR(mean(stage.accumulate(camera, settingsOf(integrator), 2)).x, 2.0f * (0.5f + 0.5f * y), 0.01f)
        << integrator.name;
}

// A small lamp above a plane: E = I cos / d^2 at the foot, by next event estimation and by BSDF samples together.
TEST(Analytic, LampAboveAPlane) {
  SceneBuilder b;
  b.place(b.prefab("plane", quad(50.0f), b.material(lambert(glm::vec3(0.5f)))));
  // A horizontal square of 0.2 m at 2 m: L = albedo / pi * Le * A cos cos / d^2 in the middle.
  b.place(b.prefab("lamp", quad(0.2f), b.material(lambert(glm::vec3(0.0f), glm::vec3(100.0f)))), at({0, 2, 0}));
  Stage stage(b.build());
  const float expected = 0.5f / kPi * 100.0f * 0.04f / 4.0f;
  for (const Integrator& integrator : kIntegrators)
    for (const bool roulette :
         {false, true}) {  // roulette also decides which faint light is sampled, and must not show
      render::ViewSettings settings = settingsOf(integrator);
      settings.roulette = roulette;
      const glm::vec3 seen = mean(stage.accumulate(lookAt({1.5f, 1.0f, 0}, {0, 0, 0}, 0.02f), settings, 64));
      EXPECT_NEAR(seen.x, expected, 0.02f * expected) << integrator.name << (roulette ? ", roulette" : "");
    }
}

// Radiance does not depend on where in the world the scene stands: 8 km out it is the same within noise.
TEST(Analytic, SameLightFarFromTheOrigin) {
  const glm::vec3 far(8000.0f, 0.0f, -8000.0f);
  glm::vec3 seen[2];
  for (int i = 0; i < 2; ++i) {
    SceneBuilder b;
    const glm::vec3 origin = i ? far : glm::vec3(0.0f);
    b.place(b.prefab("plane", quad(10.0f), b.material(lambert(glm::vec3(0.8f)))), at(origin));
    b.place(b.prefab("cube", cube(), b.material(lambert(glm::vec3(0.5f)))), at(origin + glm::vec3(0, 0.5f, 0)));
    b.environment().sun = {glm::normalize(glm::vec3(1, -1, 0.5f)), glm::vec3(3.0f), 0.0093f};
    b.environment().sky = {glm::vec3(0.5f), glm::vec3(0.5f)};
    Stage stage(b.build());
    seen[i] = mean(stage.accumulate(lookAt(origin + glm::vec3(3, 2, 3), origin), referenceSettings(), 64));
  }
  EXPECT_NEAR(seen[1].x, seen[0].x, 0.01f * seen[0].x);
}

}  // namespace
}  // namespace helio::test
