// A lamp that shines on both faces and hangs 1 mm below the ceiling, as in the Cornell box of the reference images: how
// much of the picture is light that escapes through the gap, and does the renderer have all of it?
#include <gtest/gtest.h>

#include "judge/light_tracer.h"
#include "support/scenes.h"
#include "support/stage.h"

namespace helio::test {
namespace {

using glm::vec3;

constexpr float kGap = 0.001f;  // metres
constexpr uint32_t kBounces = 8;

/// The box of the reference image without what stands in it. `sealed`: a black frame closes the gap around the lamp.
scene::ScenePtr box(bool sealed) {
  SceneBuilder b;
  const vec3 X(1, 0, 0), Y(0, 1, 0), Z(0, 0, 1);
  const float width = 5.56f, height = 5.488f, depth = 5.592f, lamp_x = 1.3f, lamp_z = 1.05f;
  const vec3 middle(-2.78f, 0.0f, -2.795f);
  const uint32_t white = b.prefab("white", quad(1.0f), b.material(lambert(vec3(0.73f))));
  const auto place = [&](uint32_t prefab, const vec3& x, const vec3& normal, const vec3& z, const vec3& at) {
    b.place(prefab, glm::mat4x3(x, normal, z, middle + at));
  };
  place(white, width * X, Y, depth * Z, {0, 0, 0});
  place(white, width * X, -Y, -depth * Z, {0, height, 0});
  place(white, width * X, Z, -height * Y, {0, 0.5f * height, -0.5f * depth});
  place(b.prefab("red", quad(1.0f), b.material(lambert({0.65f, 0.05f, 0.05f}))), -height * Y, X, depth * Z,
        {-0.5f * width, 0.5f * height, 0});
  place(b.prefab("green", quad(1.0f), b.material(lambert({0.12f, 0.45f, 0.15f}))), height * Y, -X, depth * Z,
        {0.5f * width, 0.5f * height, 0});
  place(b.prefab("lamp", quad(1.0f), b.material(lambert(vec3(0.78f), {20.0f, 14.0f, 6.0f}))), lamp_x * X, -Y,
        -lamp_z * Z, {0, height - kGap, 0});
  if (sealed) {
    const uint32_t black = b.prefab("frame", quad(1.0f), b.material(lambert(vec3(0.0f))));
    for (const float side : {-0.5f, 0.5f}) {
      place(black, lamp_x * X, Z, -kGap * Y, {0, height - 0.5f * kGap, side * lamp_z});
      place(black, kGap * Y, -X, lamp_z * Z, {side * lamp_x, height - 0.5f * kGap, 0});
    }
  }
  return b.build();
}

const scene::Camera kCamera = lookAt({-2.78f, 2.73f, 8.0f}, {-2.78f, 2.73f, -2.795f}, 0.686f);

glm::dvec3 rendered(const scene::ScenePtr& scene) {
  render::ViewSettings settings = referenceSettings();
  settings.bounces = kBounces;
  settings.roulette = false;
  settings.samples = 32;
  Stage stage(scene);
  return glm::dvec3(mean(stage.accumulate(kCamera, settings, 8)));
}

// The judge traces particles from either face of the lamp, so it knows the share of the upper one to a few percent of
// itself. The renderer's share is the difference that sealing the gap makes; both pictures have the same random
// numbers.
TEST(Gap, TheRendererHasTheLightOfTheUpperFace) {
  const judge::LightTracer judge(box(false));
  const judge::Picture picture{64, 64, kBounces};
  const judge::Estimate upper = judge.meanRadiance(kCamera, picture, {0, 1, 0}, 400'000, 1);
  const judge::Estimate lower = judge.meanRadiance(kCamera, picture, {0, -1, 0}, 400'000, 2);
  const glm::dvec3 open = rendered(box(false)), sealed = rendered(box(true));
  for (int c = 0; c < 3; ++c) {
    const double share = upper.mean[c] / lower.mean[c], error = upper.error[c] / lower.mean[c];
    EXPECT_GT(share, 0.003) << "channel " << c;
    EXPECT_NEAR(open[c] / sealed[c] - 1.0, share, 4.0 * error + 3e-4) << "channel " << c;
    EXPECT_NEAR(open[c], upper.mean[c] + lower.mean[c], 4.0 * lower.error[c] + 0.002 * lower.mean[c])
        << "channel " << c;
  }
}

}  // namespace
}  // namespace helio::test
