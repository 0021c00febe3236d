// Temporal anti-aliasing smooths what stands still as the truth does, lets go of what is gone, and believes no broken
// history.
#include "denoise/pictures.h"
#include "support/likeness.h"

namespace helio::test {
namespace {

using render::Denoiser;
using render::Primary;

/// Slats before a bright sky, all in the same light: what is wrong at one tick are the edges.
scene::ScenePtr slats() {
  SceneBuilder b;
  const uint32_t slat = b.prefab("slat", cube(), b.material(lambert(glm::vec3(0.35f))));
  for (int i = -6; i <= 6; ++i) {
    const float x = 0.31f * static_cast<float>(i);
    b.place(slat,
            glm::mat4x3({0.09f, 0.013f * static_cast<float>(i), 0}, {-0.3f, 4.0f, 0}, {0, 0, 0.05f}, {x, 0.6f, 0}));
  }
  b.environment().sky = {glm::vec3(1.0f), glm::vec3(1.0f)};
  return b.build();
}

const scene::Camera kCamera = lookAt({0.4f, 1.0f, 3.2f}, {0, 0.6f, 0});

render::ViewSettings antialiased(Denoiser denoiser = Denoiser::none, Primary primary = Primary::traced) {
  render::ViewSettings settings = live(denoiser, primary);
  settings.taa = true;
  return settings;
}

TEST(Taa, EdgesAtRestAreAsSmoothAsTheTruth) {
  const scene::ScenePtr scene = slats();
  const render::Frame reference = truth(scene, kCamera);
  for (const Primary primary : {Primary::traced, Primary::raster}) {
    Stage single(scene), averaged(scene);
    const double jagged = relativeMse(single.accumulate(kCamera, live(Denoiser::none, primary), 2), reference);
    render::Frame frame;
    for (int tick = 1; tick <= 24; ++tick) {
      frame = averaged.tick(kCamera, antialiased(Denoiser::none, primary));
      const double error = relativeMse(frame, reference);
      if (tick == 1) { EXPECT_GT(error, 0.3 * jagged); }
      if (tick == 8 || tick == 24) {
        std::printf("tick %d: relative MSE %.5f of %.5f (1/%.0f)\n", tick, error, jagged, jagged / error);
        EXPECT_LT(error, jagged / (tick == 8 ? 4.0 : 16.0)) << "tick " << tick;
      }
    }
    EXPECT_EQ(brokenTexels(frame), 0u);
    showPicture(frame, primary == Primary::raster ? "taa_raster" : "taa_traced");
    showPicture(reference, "taa_truth");
  }
}

TEST(Taa, StaysSharpWhileTheCameraMoves) {
  const scene::ScenePtr scene = slats();
  const render::Frame reference = truth(scene, kCamera);
  Stage moving(scene), jagged(scene);
  render::Frame with, without;
  for (int left = 12; left >= 0; --left) {
    scene::Camera camera = kCamera;
    camera.position.x += 0.017f * static_cast<float>(left);
    with = moving.tick(camera, antialiased());
    without = jagged.tick(camera, live(Denoiser::none));
  }
  std::printf("relative MSE in flight: %.5f, without %.5f\n", relativeMse(with, reference),
              relativeMse(without, reference));
  EXPECT_LT(relativeMse(with, reference), 0.75 * relativeMse(without, reference));
  showPicture(with, "taa_flight");
}

TEST(Taa, WhatIsGoneLeavesNoGhost) {
  const scene::ScenePtr scene = slats();
  Stage stage(scene), empty(scene);
  const render::Frame before = stage.accumulate(kCamera, antialiased(), 16);
  EXPECT_LT(mean(before).y, 0.95f);
  for (Stage* s : {&stage, &empty}) s->edit({world::DestroyRegion{{0.0f, 0.0f}, 10.0f}});
  const render::Frame after = stage.accumulate(kCamera, antialiased(), 4);
  EXPECT_LT(relativeMse(after, empty.accumulate(kCamera, antialiased(), 4)), 1e-4);
}

TEST(Taa, WhatIsBrokenInTheHistoryDoesNotSpread) {
  for (const Denoiser denoiser : {Denoiser::none, Denoiser::svgf}) {
    Stage stage(lampRoom());
    const scene::Camera camera = lookAt({0.4f, 1.6f, 4.2f}, {0, 0.6f, 0});
    render::ViewSettings settings = antialiased(denoiser);
    const render::Frame before = stage.accumulate(camera, settings, 4);
    settings.poison_history = true;
    const render::Frame after = stage.tick(camera, settings);
    EXPECT_EQ(brokenTexels(after), 0u);
    EXPECT_NEAR(mean(after).y / mean(before).y, 1.0f, 0.25f);
  }
}

TEST(Taa, CostsNothingUnlessAskedForAndRepeatsItself) {
  Stage stage(slats());
  EXPECT_FALSE(recorded(stage.tick(kCamera, live(Denoiser::none)), "taa"));
  std::vector<uint8_t> first;
  for (int run = 0; run < 2; ++run) {
    Stage again(slats());
    const render::Frame frame = again.accumulate(kCamera, antialiased(), 5);
    EXPECT_TRUE(recorded(frame, "taa"));
    if (run == 0) first = bytes(frame);
    else EXPECT_EQ(bytes(frame), first);
  }
  // A reference picture smooths by itself.
  render::ViewSettings reference = referenceSettings(kPictureWidth, kPictureHeight);
  reference.taa = true;
  EXPECT_FALSE(recorded(stage.tick(kCamera, reference), "taa"));
}

}  // namespace
}  // namespace helio::test
