// Unbiasedness: each way of finding light that claims it against the usual one, texel by texel and over blocks
// [correctness: z-tests].
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
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

/// As expectUnbiased(), for two settings that live views alone know.
void expectSameLight(const Place& place, const Change& one, const Change& other) {
  std::array<Batches, 2> batches;
  for (size_t i = 0; i < 2; ++i) {
    Stage stage(place.scene);
    stage.setStep(0.0);
    render::ViewSettings settings = referenceSettings(kWidth, 27);
    settings.mode = render::Mode::hybrid;
    settings.primary = render::Primary::traced;
    settings.samples = 32;
    settings.bounces = 3;
    settings.roulette = false;
    (i == 0 ? one : other)(settings);
    batches[i] = renderBatches(stage, place.camera, settings, kBatches);
  }
  ASSERT_NE(batches[0], batches[1]) << place.name << ": both are the same";
  EXPECT_GE(passing(welch(luminance(batches[0]), luminance(batches[1])), kAlpha), kTexelsThatPass) << place.name;
  for (size_t c = 0; c < 3; ++c)
    for (const uint32_t block : {8u, kWidth}) {
      const std::vector<double> p =
          welch(blocks(channel(batches[0], c), kWidth, block), blocks(channel(batches[1], c), kWidth, block));
      EXPECT_GE(*std::min_element(p.begin(), p.end()), sidak(kAlpha, 3 * p.size()))
          << place.name << ", channel " << c << ", blocks of " << block;
    }
}

// Of one scattering, light is direct: then both techniques have all of it, under any sky, from any surface.
TEST(Switches, DistributedRayTracingHasAllDirectLight) {
  for (const Place& place : places())
    for (const bool roulette : {false, true})
      expectSameLight(
          place, [](auto& s) { s.bounces = 0; },
          [roulette](auto& s) {
            s.bounces = 0;
            s.technique = render::Technique::distributed;
            s.ambient = render::Ambient::occluded;
            s.ambient_radius = 1e6f;
            s.roulette = roulette;
          });
}

/// Two lamps of radius `ours` on this side of a wall, and sixteen of 0.3 m behind it: more than a cell's list takes.
Place dividedRoom(float ours) {
  SceneBuilder b;
  const uint32_t grey = b.material(lambert(glm::vec3(0.6f)));
  b.place(b.prefab("floor", quad(12.0f), grey));
  b.place(b.prefab("wall", quad(12.0f), grey),
          glm::mat4x3(glm::vec3(1, 0, 0), glm::vec3(0, 0, 1), glm::vec3(0, -1, 0), glm::vec3(0, 3, -2)));
  const uint32_t lamp = b.prefab("lamp", sphere(4), b.material(lambert(glm::vec3(0.0f), glm::vec3(6.0f))));
  for (int i = 0; i < 16; ++i)
    b.place(lamp, at({-3.0f + 2.0f * static_cast<float>(i % 4), 2.0f, -3.0f - 0.7f * static_cast<float>(i / 4)}, 0.3f));
  for (const float x : {-1.5f, 1.5f}) b.place(lamp, at({x, 1.5f, 1.0f}, ours));
  return {"the divided room", b.build(), lookAt({0, 2, 6}, {0, 0.8f, 0})};
}

TEST(Switches, ListsThatLearnFindTheSameLight) {
  const Place place = dividedRoom(0.4f);  // so that nobody finds them too seldom for a test
  for (const uint32_t lamps : {1u, 3u, 0u})
    expectSameLight(
        place, [lamps](auto& s) { s.lamp_samples = lamps; },
        [lamps](auto& s) {
          s.lamp_samples = lamps;
          s.light_feedback = true;
        });
}

// ... with less noise, and fewer rays where each lamp is looked at.
TEST(Switches, ListsThatLearnLeaveHiddenLampsOut) {
  const Place place = dividedRoom(0.2f);
  std::array<double, 2> noise{};
  std::array<uint64_t, 2> rays{};
  for (const bool learns : {false, true}) {
    Stage stage(place.scene);
    stage.setStep(0.0);
    render::ViewSettings settings = referenceSettings(kWidth, 27);
    settings.mode = render::Mode::hybrid;
    settings.primary = render::Primary::traced;
    settings.bounces = 0;
    settings.samples = 16;
    settings.light_feedback = learns;
    stage.accumulate(place.camera, settings, 4);
    settings.accumulate = false;
    settings.samples = 1;
    std::vector<std::vector<float>> pictures;
    for (int i = 0; i < 8; ++i) pictures.push_back(stage.tick(place.camera, settings).radiance);
    for (size_t t = 0; t < pictures[0].size(); ++t) {
      double sum = 0.0, squares = 0.0;
      for (const auto& picture : pictures) {
        const double value = static_cast<double>(picture[t]);
        sum += value / 8.0;
        squares += value * value / 8.0;
      }
      noise[learns] += squares - sum * sum;
    }
    settings.lamp_samples = 0;
    rays[learns] = stage.tick(place.camera, settings).stats.rays.shadow;
  }
  std::printf("variance %.3f of what it was, shadow rays %.3f\n", noise[true] / noise[false],
              static_cast<double>(rays[true]) / static_cast<double>(rays[false]));
  EXPECT_LT(noise[true], 0.5 * noise[false]);
  EXPECT_LT(2 * rays[true], rays[false]);
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
