// A-SVGF keeps its history for exactly as long as the light stays what it was.
#include <array>
#include <functional>

#include "denoise/pictures.h"

namespace helio::test {
namespace {

using render::Denoiser;
using render::Inspect;
using render::Primary;

const scene::Camera kCamera = lookAt({0.4f, 1.6f, 4.2f}, {0, 0.6f, 0});
// Ids of lampRoom's instances: their places, from 1 on.
constexpr world::InstanceId kPanel = 6, kLamp = 7, kBox = 8;

/// Share of the pixels that show a surface for which `which` holds; it is given what Inspect::samples shows.
double shareOfSurfaces(const render::Frame& samples, const std::function<bool(const float*)>& which) {
  size_t surfaces = 0, counted = 0;
  for (size_t i = 0; i < samples.radiance.size(); i += 3) {
    if (!(samples.radiance[i] > 0.0f)) continue;
    ++surfaces;
    counted += which(&samples.radiance[i]);
  }
  EXPECT_GT(surfaces, samples.radiance.size() / 9);
  return static_cast<double>(counted) / static_cast<double>(surfaces);
}

TEST(Asvgf, NothingChangesWhereNothingChanges) {
  for (const Primary primary : {Primary::traced, Primary::raster}) {
    Stage stage(lampRoom());
    render::ViewSettings settings = live(Denoiser::asvgf, primary);
    stage.accumulate(kCamera, settings, 7);
    settings.inspect = Inspect::samples;
    const render::Frame samples = stage.tick(kCamera, settings);
    std::printf("A-SVGF keeps %.1f MB at 1920 x 1080\n", historyMegabytes(samples));
    EXPECT_LE(historyMegabytes(samples), kMostMegabytes);
    // Every sample that was shaded again is what it was, so no history is cut.
    EXPECT_GT(shareOfSurfaces(samples, [](const float* s) { return s[0] > 7.9f && s[1] > 7.9f; }), 0.995);
  }
}

TEST(Asvgf, FollowsTheCameraThroughAWorldThatRests) {
  Stage stage(lampRoom());
  render::ViewSettings settings = live(Denoiser::asvgf);
  render::Frame frame;
  for (int tick = 0; tick < 8; ++tick) {
    settings.inspect = tick == 7 ? Inspect::samples : Inspect::nothing;
    const float t = 0.02f * static_cast<float>(tick);
    frame = stage.tick(lookAt({0.4f + t, 1.6f, 4.2f}, {t, 0.6f, 0}), settings);
  }
  EXPECT_GT(shareOfSurfaces(frame, [](const float* s) { return s[0] > 4.0f; }), 0.6);
}

TEST(Asvgf, LampsThatGoOutAreDarkWithinThreeFrames) {
  std::array<double, 2> left{};
  for (const bool adaptive : {false, true}) {
    Stage stage(lampRoom());
    const render::ViewSettings settings = live(adaptive ? Denoiser::asvgf : Denoiser::svgf);
    const render::Frame before = stage.accumulate(kCamera, settings, 16);
    stage.edit({world::Destroy{{kPanel, kLamp}}});
    const render::Frame after = stage.accumulate(kCamera, settings, 3);
    left[adaptive] = static_cast<double>(mean(after).y / mean(before).y);
    EXPECT_EQ(brokenTexels(after), 0u);
    showPicture(after, adaptive ? "asvgf_lamps_out" : "svgf_lamps_out");
  }
  std::printf("of the light there is left after 3 frames: %.4f, with SVGF %.3f\n", left[true], left[false]);
  EXPECT_LT(left[true], 0.02);
  EXPECT_GT(left[false], 0.2);  // the test can see what stays
}

TEST(Asvgf, WhatIsDestroyedLeavesNoGhostAfterFourFrames) {
  Stage empty(lampRoom());
  empty.edit({world::Destroy{{kBox}}});
  const render::Frame expected = empty.accumulate(kCamera, live(Denoiser::asvgf), 32);
  // Its own error where nothing has ever stood, and that of a scene in which the box stood.
  Stage fresh(lampRoom()), changed(lampRoom());
  fresh.edit({world::Destroy{{kBox}}});
  changed.accumulate(kCamera, live(Denoiser::asvgf), 16);
  changed.edit({world::Destroy{{kBox}}});
  const double cold = relativeMse(fresh.accumulate(kCamera, live(Denoiser::asvgf), 4), expected);
  const render::Frame after = changed.accumulate(kCamera, live(Denoiser::asvgf), 4);
  Stage slow(lampRoom());
  slow.accumulate(kCamera, live(Denoiser::svgf), 16);
  slow.edit({world::Destroy{{kBox}}});
  const double ghost = relativeMse(slow.accumulate(kCamera, live(Denoiser::svgf), 4), expected);
  std::printf("four frames after a box was destroyed: %.5f, from a cold start %.5f, with SVGF %.5f\n",
              relativeMse(after, expected), cold, ghost);
  EXPECT_LT(relativeMse(after, expected), 1.5 * cold);
  showPicture(after, "asvgf_destroyed");
  showPicture(expected, "asvgf_destroyed_expected");
}

TEST(Asvgf, IsNearTheTruthAtRestAndRepeatsItself) {
  const scene::ScenePtr scene = lampRoom();
  const render::Frame reference = truth(scene, kCamera);
  Stage raw(scene);
  const double noise = relativeMse(raw.tick(kCamera, live(Denoiser::none)), reference);
  std::vector<uint8_t> first;
  for (int run = 0; run < 2; ++run) {
    Stage stage(scene);
    render::ViewSettings settings = live(Denoiser::asvgf);
    settings.taa = true;
    const render::Frame frame = stage.accumulate(kCamera, settings, 8);
    const double error = relativeMse(frame, reference);
    if (run == 1) {
      EXPECT_EQ(bytes(frame), first);
      continue;
    }
    first = bytes(frame);
    std::printf("relative MSE %.5f of %.4f (1/%.0f)\n", error, noise, noise / error);
    EXPECT_LT(error, noise / 20.0);
    EXPECT_TRUE(recorded(frame, "asvgf_project"));
    EXPECT_TRUE(recorded(frame, "asvgf_gradient"));
    showPicture(frame, "asvgf_room");
    showPicture(reference, "asvgf_room_truth");
  }
}

}  // namespace
}  // namespace helio::test
