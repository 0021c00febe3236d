// Hard cases: every sample finite, no more light than there is, and the truth where it is known.
#include <cmath>

#include "hard/cases.h"
#include "support/stage.h"

namespace helio::test {
namespace {

using render::Mode;
using render::Primary;

constexpr uint32_t kSize = 32, kBlock = 8, kSamplesPerTick = 16;

struct Estimate {
  double mean = 0.0, standard_error = 0.0;
};

/// Of the red channel. The error is that of the blocks' means: live pictures decide some things for tiles of pixels.
Estimate estimate(const render::Frame& frame) {
  double sum = 0.0, squares = 0.0;
  constexpr uint32_t kBlocks = kSize / kBlock * (kSize / kBlock);
  for (uint32_t block = 0; block < kBlocks; ++block) {
    double of_block = 0.0;
    for (uint32_t i = 0; i < kBlock * kBlock; ++i) {
      const uint32_t x = block % (kSize / kBlock) * kBlock + i % kBlock,
                     y = block / (kSize / kBlock) * kBlock + i / kBlock;
      of_block += static_cast<double>(texel(frame, x, y).x) / (kBlock * kBlock);
    }
    sum += of_block;
    squares += of_block * of_block;
  }
  const double mean = sum / kBlocks;
  return {mean, std::sqrt(std::max(0.0, squares / kBlocks - mean * mean) / (kBlocks - 1))};
}

struct HardTest : testing::TestWithParam<std::pair<const HardCase*, size_t>> {};

TEST_P(HardTest, HoldsInEveryMode) {
  const auto& [hard, value] = GetParam();
  const HardScene scene = hard->make(hard->values[value]);
  for (const auto& [mode, primary, name] : {std::tuple{Mode::reference, Primary::traced, "reference"},
                                            {Mode::hybrid, Primary::traced, "hybrid, traced"},
                                            {Mode::hybrid, Primary::raster, "hybrid, raster"}}) {
    SCOPED_TRACE(hard->name + ", " + std::to_string(hard->values[value]) + " " + hard->parameter + ", " + name);
    Stage stage(scene.scene);
    render::ViewSettings settings = referenceSettings(kSize, kSize);
    settings.mode = mode;
    settings.primary = primary;
    settings.bounces = scene.bounces;
    settings.roulette = mode == Mode::hybrid;
    settings.samples = kSamplesPerTick;
    const render::Frame frame =
        stage.accumulate(scene.camera, settings, (scene.samples + kSamplesPerTick - 1) / kSamplesPerTick);
    EXPECT_EQ(frame.stats.nonfinite, 0u);
    for (const float radiance : frame.radiance) {
      ASSERT_TRUE(std::isfinite(radiance));
      ASSERT_GE(radiance, 0.0f);
    }
    const Estimate seen = estimate(frame);
    const double noise = 4.5 * seen.standard_error;
    EXPECT_LE(seen.mean, scene.bound * std::max(1.0, scene.truth.value_or(1.0)) + noise);
    if (scene.truth) { EXPECT_NEAR(seen.mean, *scene.truth, scene.tolerance * *scene.truth + noise); }
  }
}

std::vector<std::pair<const HardCase*, size_t>> all() {
  std::vector<std::pair<const HardCase*, size_t>> list;
  for (const HardCase& hard : hardCases())
    for (size_t i = 0; i < hard.values.size(); ++i) list.emplace_back(&hard, i);
  return list;
}

INSTANTIATE_TEST_SUITE_P(Hard, HardTest, testing::ValuesIn(all()), [](const auto& info) {
  return info.param.first->name + "_" + std::to_string(info.param.second + 1);
});

}  // namespace
}  // namespace helio::test
