// The renderer's reference mode against the judge, on scenes that have no closed form; and the judge against ones that
// have.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "judge/path_tracer.h"
#include "support/batches.h"
#include "support/scenes.h"

namespace helio::test {
namespace {

constexpr double kAlpha = 0.01;
constexpr double kTexelsThatPass = 0.9975;

/// Mean of all values of all batches.
double mean(const Batches& batches) {
  double sum = 0.0;
  for (const std::vector<double>& batch : batches)
    for (double v : batch) sum += v / static_cast<double>(batch.size() * batches.size());
  return sum;
}

// ---- Is the judge fit for office? ----

Batches judged(const scene::ScenePtr& scene, const scene::Camera& camera, uint32_t bounces, uint32_t samples) {
  return judge::PathTracer(scene).render(camera, {16, 16, bounces}, samples, 4, 1);
}

TEST(Judge, SeesALambertPlaneUnderASkyAndASun) {
  SceneBuilder b;
  b.place(b.prefab("plane", quad(1000.0f), b.material(lambert(glm::vec3(0.8f)))));
  b.environment().sky = {glm::vec3(1.0f), glm::vec3(1.0f)};
  const scene::Camera down = lookAt({0, 10, 0}, {0, 0, 0});
  EXPECT_NEAR(mean(judged(b.build(), down, 0, 4)), 0.8, 1e-6);
  // A disc high above: E cos / pi on top.
  b.environment().sun = {{0.0f, -1.0f, 0.0f}, glm::vec3(2.0f), 0.5f};
  EXPECT_NEAR(mean(judged(b.build(), down, 0, 512)), 0.8 + 0.8 * 2.0 / judge::kPi, 0.01);
}

TEST(Judge, SeesAClosedShiningBox) {
  SceneBuilder b;
  b.place(b.prefab("box", cube(), b.material(lambert(glm::vec3(0.7f), glm::vec3(0.5f)))), at({0, 0, 0}, 4.0f));
  const double expected = 0.5 * (1.0 + 0.7 + 0.49 + 0.343 + 0.2401);  // 0 to 4 scatterings
  EXPECT_NEAR(mean(judged(b.build(), lookAt({0, 0, 0}, {1, 0.3f, 0.2f}, 1.2f), 3, 4)), expected, 1e-6);
}

TEST(Judge, SeesTheSkyInAMirror) {
  SceneBuilder b;
  b.place(b.prefab("mirror", quad(100.0f), b.material(metal(glm::vec3(1.0f), 0.0f))));
  b.environment().sky = {glm::vec3(2.0f), glm::vec3(0.0f)};
  EXPECT_NEAR(mean(judged(b.build(), lookAt({0, 5, 0}, {0, 0, -5}, 0.01f), 1, 4)), 1.0 + std::sqrt(0.5), 1e-3);
}

TEST(Judge, RefusesTextures) { EXPECT_THROW(judge::PathTracer{stillLife()}, std::invalid_argument); }

// ---- What it says of the renderer ----

struct Trial {
  scene::ScenePtr scene;
  scene::Camera camera;
  uint32_t bounces;
  uint32_t judge_samples;  ///< a texel and batch: enough that hardly a texel misses its lamp in all of them
};

void expectAgreement(const Trial& trial, const std::string& name) {
  constexpr uint32_t kWidth = 64, kHeight = 36, kBatches = 16;
  render::ViewSettings settings = referenceSettings(kWidth, kHeight);
  settings.bounces = trial.bounces;
  settings.samples = 32;
  Stage stage(trial.scene);
  const Batches seen = renderBatches(stage, trial.camera, settings, kBatches);
  showPicture(stage.tick(trial.camera, settings), "judged_" + name);
  const Batches truth = judge::PathTracer(trial.scene)
                            .render(trial.camera, {kWidth, kHeight, trial.bounces}, trial.judge_samples, kBatches, 7);

  EXPECT_GE(passing(welch(luminance(seen), luminance(truth)), kAlpha), kTexelsThatPass);
  for (size_t c = 0; c < 3; ++c) {
    const Batches a = channel(seen, c), b = channel(truth, c);
    for (const uint32_t block : {8u, kWidth}) {
      const Batches seen_blocks = blocks(a, kWidth, block), truth_blocks = blocks(b, kWidth, block);
      const std::vector<double> p = welch(seen_blocks, truth_blocks);
      const auto worst = static_cast<size_t>(std::min_element(p.begin(), p.end()) - p.begin());
      EXPECT_GE(p[worst], sidak(kAlpha, 3 * p.size()))
          << "channel " << c << ", blocks of " << block << ": block " << worst << " is " << means(seen_blocks)[worst]
          << ", the judge says " << means(truth_blocks)[worst];
    }
    EXPECT_NEAR(mean(a), mean(b), 0.01 * mean(b)) << "channel " << c;
  }
}

TEST(Judge, AgreesOnARoomOfLampsAndMetals) {
  expectAgreement({lampRoom(), lookAt({0, 2, 6.5f}, {0, 1.8f, 0}), 4, 64}, "room");
}

TEST(Judge, AgreesOnAPatchUnderSunAndSky) {
  expectAgreement({sunlitPatch(), lookAt({0.3f, 1.8f, 4.0f}, {0, 0.5f, 0}), 3, 64}, "patch");
}

// Direct light alone: paths of one scattering.
TEST(Judge, AgreesOnDirectLight) {
  expectAgreement({lampRoom(), lookAt({0, 2, 6.5f}, {0, 1.8f, 0}), 0, 320}, "direct");
}

}  // namespace
}  // namespace helio::test
