// Indirect light that only some pixels follow, and what the others make of their neighbours' rays.
#include "denoise/pictures.h"

namespace helio::test {
namespace {

using render::Denoiser;
using render::IndirectRate;
using render::Reconstruction;

const scene::Camera kCamera = lookAt({0.4f, 1.6f, 4.2f}, {0, 0.6f, 0});

struct Rate {
  const char* name;
  IndirectRate rate;
  double pixels;  // that follow their paths
};
constexpr Rate kRates[] = {{"half", IndirectRate::half, 0.5}, {"quarter", IndirectRate::quarter, 0.25}};

render::ViewSettings atRate(IndirectRate rate, Reconstruction reconstruction = Reconstruction::reuse) {
  render::ViewSettings settings = live(Denoiser::none);
  settings.indirect_rate = rate;
  settings.reconstruction = reconstruction;
  return settings;
}

TEST(Rate, FollowsAsManyPathsAsItSays) {
  Stage stage(lampRoom());
  render::ViewSettings settings = live(Denoiser::none);
  settings.bounces = 0;  // the rays that surfaces send on, each to its end
  settings.roulette = false;
  const auto whole = static_cast<double>(stage.tick(kCamera, settings).stats.rays.bounce);
  for (const Rate& each : kRates) {
    settings.indirect_rate = each.rate;
    EXPECT_NEAR(static_cast<double>(stage.tick(kCamera, settings).stats.rays.bounce) / whole, each.pixels, 0.02)
        << each.name;
  }
}

// Where the same light comes from everywhere, every ray says the same: the ratio has no noise.
TEST(Rate, ReusedRaysOfAFurnaceAreExact) {
  SceneBuilder b;
  b.place(b.prefab("ground", quad(40.0f), b.material(lambert(glm::vec3(0.7f, 0.5f, 0.3f)))));
  b.environment().sky = {glm::vec3(1.0f), glm::vec3(1.0f)};
  Stage stage(b.build());
  for (const Rate& each : kRates) {
    render::ViewSettings settings = atRate(each.rate);
    settings.bounces = 0;
    settings.roulette = false;
    const render::Frame frame = stage.tick(lookAt({0, 3, 3}, {0, 0, 0}), settings);
    for (size_t i = 0; i < frame.radiance.size(); i += 3) {
      ASSERT_NEAR(frame.radiance[i], 0.7f, 0.01f) << each.name;
      ASSERT_NEAR(frame.radiance[i + 2], 0.3f, 0.005f) << each.name;
    }
  }
}

/// The mean picture of many ticks, whose noise is gone.
std::vector<double> meanPicture(const scene::ScenePtr& scene, const render::ViewSettings& settings, int ticks,
                                double* noise = nullptr) {
  Stage stage(scene);
  stage.setStep(0.0);
  std::vector<double> sum, squares;
  for (int tick = 0; tick < ticks; ++tick) {
    const render::Frame frame = stage.tick(kCamera, settings);
    EXPECT_EQ(brokenTexels(frame), 0u);
    sum.resize(frame.radiance.size());
    squares.resize(sum.size());
    for (size_t i = 0; i < sum.size(); ++i) {
      sum[i] += static_cast<double>(frame.radiance[i]) / ticks;
      squares[i] += std::pow(static_cast<double>(frame.radiance[i]), 2.0) / ticks;
    }
  }
  if (noise)
    for (size_t i = 0; i < sum.size(); ++i) *noise += (squares[i] - sum[i] * sum[i]) / static_cast<double>(sum.size());
  return sum;
}

double total(const std::vector<double>& picture) {
  double sum = 0.0;
  for (const double value : picture) sum += value;
  return sum / static_cast<double>(picture.size());
}

TEST(Rate, KeepsTheLightAndMuchOfItsDetail) {
  for (const auto& [name, scene] : {std::pair{"lamp room", lampRoom()}, std::pair{"sunlit patch", sunlitPatch()}}) {
    constexpr int kTicks = 64;
    double raw = 0.0;
    const std::vector<double> expected = meanPicture(scene, live(Denoiser::none), kTicks, &raw);
    for (const Rate& each : kRates)
      for (const Reconstruction reconstruction : {Reconstruction::reuse, Reconstruction::bilateral}) {
        double noise = 0.0;
        const std::vector<double> found = meanPicture(scene, atRate(each.rate, reconstruction), kTicks, &noise);
        double bias = 0.0;
        for (size_t i = 0; i < found.size(); ++i)
          bias += std::pow(found[i] - expected[i], 2.0) / (expected[i] * expected[i] + 0.01) /
                  static_cast<double>(found.size());
        std::printf("%s, %s, %s: light %.3f, relative bias^2 %.4f, noise %.3f of the full rate's\n", name, each.name,
                    reconstruction == Reconstruction::reuse ? "reuse" : "bilateral", total(found) / total(expected),
                    bias, noise / raw);
        EXPECT_NEAR(total(found) / total(expected), 1.0, 0.06);
        EXPECT_LT(bias, 0.08);
        EXPECT_LT(noise, raw);  // many rays a pixel, though only some are new
      }
  }
}

TEST(Rate, IsWhatDenoisersAreGiven) {
  const scene::ScenePtr scene = lampRoom();
  const render::Frame reference = truth(scene, kCamera);
  Stage raw(scene);
  const double noise = relativeMse(raw.tick(kCamera, live(Denoiser::none)), reference);
  for (const Denoiser denoiser : {Denoiser::svgf, Denoiser::reblur}) {
    Stage stage(scene);
    render::ViewSettings settings = atRate(IndirectRate::quarter);
    settings.denoiser = denoiser;
    const render::Frame frame = stage.accumulate(kCamera, settings, 8);
    const double error = relativeMse(frame, reference);
    std::printf("quarter rate, denoised: 1/%.0f of the raw frame's error\n", noise / error);
    EXPECT_LT(error, noise / 12.0);
    EXPECT_TRUE(recorded(frame, "reconstruct"));
    showPicture(frame, denoiser == Denoiser::svgf ? "quarter_svgf" : "quarter_reblur");
  }
  Stage full(scene);
  EXPECT_FALSE(recorded(full.tick(kCamera, live(Denoiser::none)), "reconstruct"));
}

}  // namespace
}  // namespace helio::test
