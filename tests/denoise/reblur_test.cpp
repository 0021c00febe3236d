// What a recurrent blur keeps is near the truth, and no older than the light is.
#include "denoise/pictures.h"
#include "support/likeness.h"

namespace helio::test {
namespace {

using render::Denoiser;
using render::Inspect;

const scene::Camera kCamera = lookAt({0.4f, 1.6f, 4.2f}, {0, 0.6f, 0});
// Ids of lampRoom's instances: their places, from 1 on.
constexpr world::InstanceId kPanel = 6, kLamp = 7, kBox = 8;

TEST(Reblur, IsNearTheTruthAtRestAndRepeatsItself) {
  const scene::ScenePtr scene = lampRoom();
  const render::Frame reference = truth(scene, kCamera);
  Stage raw(scene);
  const double noise = relativeMse(raw.tick(kCamera, live(Denoiser::none)), reference);
  std::vector<uint8_t> first;
  for (int run = 0; run < 2; ++run) {
    Stage stage(scene);
    render::Frame frame;
    for (int tick = 1; tick <= 8; ++tick) {
      frame = stage.tick(kCamera, live(Denoiser::reblur));
      EXPECT_EQ(brokenTexels(frame), 0u);
      const double error = relativeMse(frame, reference);
      if (run == 0 && (tick == 1 || tick == 8)) {
        std::printf("tick %d: relative MSE %.5f of %.4f (1/%.0f), similarity %.3f\n", tick, error, noise, noise / error,
                    structuralSimilarity(*frame.pixels, *reference.pixels));
        EXPECT_LT(error, noise / (tick == 1 ? 8.0 : 20.0)) << "tick " << tick;
        EXPECT_NEAR(mean(frame).y / mean(reference).y, 1.0f, 0.08f) << "tick " << tick;
      }
    }
    if (run == 0) first = bytes(frame);
    else EXPECT_EQ(bytes(frame), first);
    for (const char* pass :
         {"reblur_preblur", "reblur_temporal", "reblur_history_fix", "reblur_blur", "reblur_stabilise"})
      EXPECT_TRUE(recorded(frame, pass)) << pass;
    std::printf("ReBLUR keeps %.1f MB at 1920 x 1080\n", historyMegabytes(frame));
    EXPECT_LE(historyMegabytes(frame), kMostMegabytes);
    showPicture(frame, "reblur_room");
    showPicture(reference, "reblur_room_truth");
  }
}

TEST(Reblur, LampsThatGoOutAreDarkWithinThreeFrames) {
  Stage stage(lampRoom());
  const render::ViewSettings settings = live(Denoiser::reblur);
  const render::Frame before = stage.accumulate(kCamera, settings, 16);
  stage.edit({world::Destroy{{kPanel, kLamp}}});
  const render::Frame after = stage.accumulate(kCamera, settings, 3);
  EXPECT_LT(mean(after).y / mean(before).y, 0.02f);
  EXPECT_EQ(brokenTexels(after), 0u);
}

TEST(Reblur, WhatIsDestroyedLeavesNoGhostAfterFourFrames) {
  Stage empty(lampRoom());
  empty.edit({world::Destroy{{kBox}}});
  const render::Frame expected = empty.accumulate(kCamera, live(Denoiser::reblur), 32);
  // Its own error where nothing has ever stood, and that of a scene in which the box stood.
  Stage fresh(lampRoom()), changed(lampRoom());
  fresh.edit({world::Destroy{{kBox}}});
  changed.accumulate(kCamera, live(Denoiser::reblur), 16);
  changed.edit({world::Destroy{{kBox}}});
  const double cold = relativeMse(fresh.accumulate(kCamera, live(Denoiser::reblur), 4), expected);
  const render::Frame after = changed.accumulate(kCamera, live(Denoiser::reblur), 4);
  std::printf("four frames after a box was destroyed: %.5f, from a cold start %.5f\n", relativeMse(after, expected),
              cold);
  EXPECT_LT(relativeMse(after, expected), 1.5 * cold);
  showPicture(after, "reblur_destroyed");
}

// Its history is one for as long as nothing changes, and follows the camera.
TEST(Reblur, GathersTicksAlongTheMotionOfTheCamera) {
  Stage stage(sunlitPatch());
  render::ViewSettings settings = live(Denoiser::reblur);
  render::Frame frame;
  for (int tick = 0; tick < 8; ++tick) {
    settings.inspect = tick == 7 ? Inspect::samples : Inspect::nothing;
    const float t = 0.02f * static_cast<float>(tick);
    frame = stage.tick(lookAt({0.4f + t, 1.6f, 4.2f}, {t, 0.6f, 0}), settings);
  }
  size_t surfaces = 0, followed = 0;
  for (size_t i = 0; i < frame.radiance.size(); i += 3) {
    surfaces += frame.radiance[i] > 0.0f;
    followed += frame.radiance[i] > 5.0f;
  }
  EXPECT_GT(static_cast<double>(followed), 0.75 * static_cast<double>(surfaces));
}

// The first frame behind a jump is one of blurs alone; the error falls from there.
TEST(Reblur, RecoversAfterAJump) {
  const scene::ScenePtr scene = sunlitPatch();
  const render::Frame reference = truth(scene, kCamera);
  Stage stage(scene);
  stage.accumulate(lookAt({60.0f, 9.0f, 40.0f}, {0, 0, 0}), live(Denoiser::reblur), 4);
  double error = 0.0;
  std::vector<double> recovery;
  for (int tick = 0; tick < 8; ++tick) {
    error = relativeMse(stage.tick(kCamera, live(Denoiser::reblur)), reference);
    recovery.push_back(error);
  }
  Stage raw(scene);
  const double noise = relativeMse(raw.tick(kCamera, live(Denoiser::none)), reference);
  std::printf("after a jump 1/%.1f, eight frames later 1/%.1f of the raw frame's error\n", noise / recovery.front(),
              noise / recovery.back());
  EXPECT_LT(recovery.front(), noise);
  EXPECT_LT(recovery.back(), noise / 8.0);
}

}  // namespace
}  // namespace helio::test
