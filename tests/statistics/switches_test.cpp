// Unbiasedness: each way of finding light that claims it against the usual one, texel by texel and over blocks
// [correctness: z-tests].
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "support/batches.h"
#include "support/scenes.h"

namespace helio::test {
namespace {

constexpr double kAlpha = 0.01;
constexpr double kTexelsThatPass = 0.9975;
constexpr uint32_t kBatches = 16;
constexpr uint32_t kWidth = 48;

struct Place {
  const char* name;
  scene::ScenePtr scene;
  scene::Camera camera;
};
std::vector<Place> places() {
  return {{"the room", lampRoom(), lookAt({0, 2, 6.5f}, {0, 1.8f, 0})},
          {"the patch", sunlitPatch(), lookAt({0, 2, 4}, {0, 0.4f, 0})}};
}

using Change = std::function<void(render::ViewSettings&)>;

/// The change must change the samples, and must not change their mean.
void expectUnbiased(const Place& place, const Change& change) {
  Stage stage(place.scene);
  render::ViewSettings settings = referenceSettings(kWidth, 27);
  settings.samples = 32;
  settings.bounces = 3;
  settings.roulette = false;
  const Batches usual = renderBatches(stage, place.camera, settings, kBatches);
  change(settings);
  const Batches changed = renderBatches(stage, place.camera, settings, kBatches);
  ASSERT_NE(usual, changed) << place.name << ": the switch did nothing";

  EXPECT_GE(passing(welch(luminance(changed), luminance(usual)), kAlpha), kTexelsThatPass) << place.name;
  for (size_t c = 0; c < 3; ++c)
    for (const uint32_t block : {8u, kWidth}) {
      const std::vector<double> p =
          welch(blocks(channel(changed, c), kWidth, block), blocks(channel(usual, c), kWidth, block));
      EXPECT_GE(*std::min_element(p.begin(), p.end()), sidak(kAlpha, 3 * p.size()))
          << place.name << ", channel " << c << ", blocks of " << block;
    }
}

// Lamps and a wide sun are found by chance too, if seldom.
TEST(Switches, ScatteredRaysAloneFindTheSameLight) {
  for (const Place& place : places()) expectUnbiased(place, [](auto& s) { s.light_sampling = false; });
}

TEST(Switches, LightSamplingAloneFindsTheSameLight) {
  for (const Place& place : places()) expectUnbiased(place, [](auto& s) { s.mis = false; });
}

TEST(Switches, LookingForTheSkyFindsTheSameLight) {
  expectUnbiased(places()[1], [](auto& s) { s.sky_sampling = true; });
}

TEST(Switches, LookingForTheSkyAloneFindsTheSameLight) {
  expectUnbiased(places()[1], [](auto& s) {
    s.sky_sampling = true;
    s.mis = false;
  });
}

TEST(Switches, SeveralLampsFindTheSameLight) {
  expectUnbiased(places()[0], [](auto& s) { s.lamp_samples = 4; });
}

TEST(Switches, EachLampOnceFindsTheSameLight) {
  expectUnbiased(places()[0], [](auto& s) { s.lamp_samples = 0; });
}

TEST(Switches, LampsOfTheWholeWorldFindTheSameLight) {
  expectUnbiased(places()[0], [](auto& s) { s.light_lists = false; });
}

// Regularisation is biased, and so is left out of reference pictures, bit for bit; in live ones it must do something.
TEST(Switches, RegularisationStaysOutOfTheReference) {
  const Place place = places()[1];
  for (const render::Mode mode : {render::Mode::reference, render::Mode::hybrid}) {
    Stage stage(place.scene);
    render::ViewSettings settings = referenceSettings(kWidth, 27);
    settings.mode = mode;
    settings.samples = 8;
    const std::vector<float> plain = stage.accumulate(place.camera, settings, 1).radiance;
    settings.regularisation = 0.5f;
    const std::vector<float> regular = Stage(place.scene).accumulate(place.camera, settings, 1).radiance;
    const std::vector<float> again = Stage(place.scene).accumulate(place.camera, settings, 1).radiance;
    EXPECT_EQ(regular, again);
    if (mode == render::Mode::reference) EXPECT_EQ(plain, regular);
    else EXPECT_NE(plain, regular);
  }
}

}  // namespace
}  // namespace helio::test
