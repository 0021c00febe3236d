// What denoisers say of their noise, against the noise that there is; and what a controller makes of it on a device.
#include <algorithm>
#include <cstdio>

#include "denoise/pictures.h"
#include "render/controller.h"

namespace helio::test {
namespace {

using render::Controller;
using render::Denoiser;
using render::Goal;

const scene::Camera kCamera = lookAt({0.4f, 1.6f, 4.2f}, {0, 0.6f, 0});

render::ViewSettings small(Denoiser denoiser) {
  render::ViewSettings settings = live(denoiser);
  settings.width = 40;
  settings.height = 24;
  return settings;
}

struct Noise {
  double true_variance = 0.0, estimated = 0.0;
};

/// Of the sixth picture of runs with random numbers of their own.
Noise noiseOf(const scene::ScenePtr& scene, const render::ViewSettings& settings) {
  constexpr uint32_t kRuns = 5, kTicks = 6;
  Stage stage(scene);
  render::ViewSettings forgetful = settings;  // another light transport forgets all history, while seeds go on
  forgetful.round_surfaces = !settings.round_surfaces;
  std::vector<std::vector<float>> pictures;
  Noise noise;
  for (uint32_t run = 0; run < kRuns; ++run) {
    stage.tick(kCamera, forgetful);
    const render::Frame frame = stage.accumulate(kCamera, settings, kTicks);
    EXPECT_TRUE(frame.stats.variance.has_value());
    noise.estimated += frame.stats.variance.value_or(0.0) / kRuns;
    pictures.push_back(frame.radiance);
  }
  for (size_t i = 0; i < pictures.front().size(); ++i) {
    double sum = 0.0, squares = 0.0;
    for (const auto& picture : pictures) {
      const auto value = static_cast<double>(picture[i]);
      sum += value;
      squares += value * value;
    }
    const double middle = sum / kRuns;
    noise.true_variance += (squares - sum * middle) / (kRuns - 1.0) / (middle * middle + 0.01);
  }
  noise.true_variance /= static_cast<double>(pictures.front().size());
  return noise;
}

TEST(ErrorEstimate, IsOfTheOrderOfTheNoiseThatThereIs) {
  for (const Denoiser denoiser : {Denoiser::svgf, Denoiser::asvgf}) {
    for (const bool sunlit : {false, true}) {
      const Noise noise = noiseOf(sunlit ? sunlitPatch() : lampRoom(), small(denoiser));
      std::printf("%s, %s: variance %.6f, estimated %.6f\n", denoiser == Denoiser::svgf ? "svgf" : "asvgf",
                  sunlit ? "sunlit patch" : "lamp room", noise.true_variance, noise.estimated);
      EXPECT_GT(noise.estimated, noise.true_variance / 4.0);
      EXPECT_LT(noise.estimated, noise.true_variance * 2.0);
    }
  }
}

TEST(ErrorEstimate, FallsWithSamplesAndAtRest) {
  const scene::ScenePtr scene = lampRoom();
  render::ViewSettings settings = small(Denoiser::svgf);
  settings.width = settings.height = 20;
  settings.bounces = 1;
  const double one = noiseOf(scene, settings).estimated;
  settings.samples = 8;
  const double eight = noiseOf(scene, settings).estimated;
  EXPECT_LT(eight, 0.6 * one);
  EXPECT_GT(eight, 0.0);
  settings.accumulate = true;
  settings.samples = 64;
  Stage stage(scene);
  const double early = *stage.accumulate(kCamera, settings, 1).stats.variance;
  const double late = *stage.accumulate(kCamera, settings, 18).stats.variance;
  EXPECT_LT(late, 0.2 * early) << "the mean of 1,216 samples";
  EXPECT_GT(late, 0.0);
}

TEST(ErrorEstimate, IsNothingWhereNothingIsUncertain) {
  const scene::ScenePtr scene = lampRoom();
  Stage stage(scene);
  scene::Camera sky = kCamera;
  sky.position = {0, 50, 0};
  sky.forward = {0, 1, 0};
  sky.up = {0, 0, 1};
  EXPECT_EQ(stage.accumulate(sky, small(Denoiser::svgf), 3).stats.variance, 0.0) << "the sky has no noise";
  EXPECT_FALSE(stage.tick(kCamera, small(Denoiser::none)).stats.variance.has_value()) << "nobody knows";
  EXPECT_TRUE(recorded(stage.tick(kCamera, small(Denoiser::svgf)), "error_estimate"));
}

// ---- The controller on a device ----

/// Each tick's picture, and what the next is decided by.
struct Session {
  std::vector<render::Observation> log;
  std::vector<std::vector<uint8_t>> pictures;
  std::vector<size_t> rungs;
};

/// `observed`: of the frame of a tick; in a live session what was measured, in a replay what was logged.
template <typename Observed>
Session play(const scene::ScenePtr& scene, uint32_t ticks, const Observed& observed) {
  Stage stage(scene);
  Controller controller(render::usualPrices(), {Goal::Kind::max_frame_ms, 10'000.0});
  render::ViewSettings wanted = small(Denoiser::none);
  wanted.width = 32;
  wanted.height = 18;
  Session session;
  for (uint32_t tick = 0; tick < ticks; ++tick) {
    const size_t rung = controller.decision().rung;
    const render::ViewSettings settings = render::onRung(wanted, rung);
    scene::Camera camera = kCamera;
    camera.position.x += 0.02f * static_cast<float>(tick);
    const render::Frame frame = stage.tick(camera, settings);
    EXPECT_EQ(frame.stats.rays.primary, uint64_t{32} * 18 * render::kLadder[rung].samples) << "the rung is in force";
    EXPECT_TRUE(recorded(frame, "svgf_atrous"));
    session.rungs.push_back(rung);
    session.pictures.push_back(bytes(frame));
    session.log.push_back(observed(tick, render::observe(frame.stats, settings)));
    controller.observe(session.log.back());
  }
  return session;
}

TEST(Controlled, ASessionReplaysBitForBitFromWhatWasMeasured) {
  const scene::ScenePtr scene = stillLife();
  // It climbs, since nothing is late; then something holds the device up for a while.
  const Session lived = play(scene, 44, [](uint32_t tick, render::Observation measured) {
    measured.gpu_ms *= 1e-3;  // a machine of many tests is no measure: as if on a quicker device
    measured.scaling_ms *= 1e-3;
    if (tick >= 30 && tick < 33) measured.gpu_ms += 20'000.0;
    return measured;
  });
  EXPECT_GE(*std::max_element(lived.rungs.begin(), lived.rungs.end()), 2u);
  EXPECT_LT(lived.rungs.back(), *std::max_element(lived.rungs.begin(), lived.rungs.end()));
  for (const auto& observation : lived.log) {
    EXPECT_GT(observation.scaling_ms, 0.0);
    EXPECT_LT(observation.scaling_ms, observation.gpu_ms);
    EXPECT_TRUE(observation.variance.has_value());
    EXPECT_FALSE(observation.still);
  }
  const Session replayed = play(scene, 44, [&](uint32_t tick, const render::Observation&) { return lived.log[tick]; });
  EXPECT_EQ(replayed.rungs, lived.rungs);
  for (size_t tick = 0; tick < lived.pictures.size(); ++tick)
    ASSERT_EQ(replayed.pictures[tick], lived.pictures[tick]) << "tick " << tick;
}

TEST(Controlled, AnotherRungKeepsTheHistory) {
  Stage stage(stillLife());
  render::ViewSettings settings = small(Denoiser::svgf);
  settings.inspect = render::Inspect::samples;
  settings.bounces = 3;
  stage.accumulate(kCamera, settings, 5);
  settings.bounces = 1;
  const render::Frame frame = stage.tick(kCamera, settings);
  size_t long_histories = 0;
  for (size_t i = 0; i < frame.radiance.size(); i += 3) long_histories += frame.radiance[i] > 4.0f;
  EXPECT_GT(long_histories, frame.radiance.size() / 3 / 2) << "of samples that the pixels' histories hold";
}

}  // namespace
}  // namespace helio::test
