// A reference of a frozen copy: what happens to the world meanwhile does not reach it, and live pictures converge to
// it.
#include "render/reference.h"

#include <cstdio>

#include "render/metrics/flip.h"
#include "support/scenes.h"
#include "support/stage.h"

namespace helio::test {
namespace {

using render::ReferencePicture;

const scene::Camera kCamera = lookAt({0.4f, 1.6f, 4.2f}, {0, 0.6f, 0});

render::ViewSettings liveSettings() {
  render::ViewSettings settings;
  settings.width = 48;
  settings.height = 32;
  settings.auto_exposure = false;
  settings.keep_radiance = true;
  return settings;
}

/// The stage has had a tick: the first one's changes are the scene, and this takes what there is since.
std::unique_ptr<ReferencePicture> freeze(Stage& stage, const scene::ScenePtr& scene, uint32_t bounces) {
  world::ChangeSet whole;
  (void)stage.world().beginTick(0.0, &whole);  // the stage's next tick misses nothing: there were no edits
  auto made = ReferencePicture::make(renderer(), scene, std::move(whole), kCamera,
                                     render::referenceOf(liveSettings(), bounces, 1.0));
  EXPECT_TRUE(made.ok()) << made.error().message;
  return std::move(*made);
}

void growTo(ReferencePicture& reference, uint32_t samples) {
  while (reference.samples() < samples) {
    const auto grown = reference.grow(1);
    ASSERT_TRUE(grown.ok()) << grown.error().message;
  }
}

TEST(Reference, OfAFrozenCopyHeedsNoEdit) {
  const scene::ScenePtr scene = stillLife();
  Stage stage(scene);
  stage.tick(kCamera, liveSettings());
  const auto frozen = freeze(stage, scene, 3), twin = freeze(stage, scene, 3);
  growTo(*frozen, 4);
  // Half of the world goes, the sun sets, and the clock goes on, between this copy's ticks.
  std::vector<world::InstanceId> ids;
  for (world::InstanceId id = 2; id <= stage.world().instanceCount(); id += 2) ids.push_back(id);
  stage.edit({world::Destroy{ids}, world::SetSun{{{1.0f, -0.1f, 0.0f}, glm::vec3(0.5f), 0.01f}, false}});
  stage.tick(kCamera, liveSettings());
  growTo(*frozen, 8);
  growTo(*twin, 8);
  EXPECT_EQ(frozen->image().rgb, twin->image().rgb) << "bit for bit what nothing happened beside";
  const auto after = freeze(stage, scene, 3);
  growTo(*after, 8);
  EXPECT_NE(after->image().rgb, frozen->image().rgb) << "the test can see the edit";
}

TEST(Reference, HoldsWhatUsersMadeOfTheWorldAndTheTimeOfTheClock) {
  const scene::ScenePtr scene = stillLife();
  Stage stage(scene), built(scene);
  const std::vector<world::Edit> edits{world::Destroy{{2, 3}},
                                       world::Move{4, {{0.5f, 1.2f, 0.3f}, {1, 0, 0, 0}, 1.0f}}};
  stage.edit(edits);
  stage.tick(kCamera, liveSettings());
  const auto copy = freeze(stage, scene, 2);
  growTo(*copy, 4);
  built.edit(edits);
  render::ViewSettings settings = render::referenceOf(liveSettings(), 2, 1.0);
  const render::Frame expected = built.accumulate(kCamera, settings, 4);
  EXPECT_EQ(copy->image().rgb, expected.radiance) << "the same picture as of the world itself";
}

TEST(Reference, AConvergedLivePictureIsAsFarFromItAsNoiseIs) {
  // Without approximations the live picture has no bias: all of its error is noise, its own and the reference's.
  const scene::ScenePtr scene = lampRoom();
  Stage stage(scene);
  stage.tick(kCamera, liveSettings());
  const auto reference = freeze(stage, scene, 3);
  constexpr uint32_t kSamples = 256;
  growTo(*reference, kSamples / 2);
  const metrics::Image half = reference->image();
  growTo(*reference, kSamples);
  const metrics::Image truth = reference->image();
  const double floor = metrics::noiseFloor(half, metrics::rest(truth, kSamples, half, kSamples / 2));

  render::ViewSettings settings = liveSettings();
  settings.primary = render::Primary::traced;  // its own positions in the pixel, as the reference
  settings.levels_of_detail = false;
  settings.samples = 16;
  std::vector<double> errors;
  metrics::Image picture;
  for (uint32_t tick = 1; tick <= 16; ++tick) {
    const render::Frame frame = stage.tick(kCamera, settings);
    picture = {settings.width, settings.height, frame.radiance};
    if (tick == 1 || tick == 4 || tick == 16) errors.push_back(metrics::relativeMse(picture, truth));
  }
  std::printf("relative MSE %.5f, %.5f, %.5f after 16, 64, 256 samples; noise of the reference %.5f\n", errors[0],
              errors[1], errors[2], floor);
  EXPECT_LT(errors[1], 0.7 * errors[0]);
  EXPECT_LT(errors[2], 0.7 * errors[1]);
  // Noise falls with the number of samples. What would be left of the error at any number, by the last two, is the
  // reference's own noise, and no bias.
  EXPECT_NEAR((4.0 * errors[2] - errors[1]) / 3.0, floor, 0.5 * floor);
}

TEST(Reference, IsShownWithTheLivePicturesExposure) {
  const scene::ScenePtr scene = lampRoom();
  Stage stage(scene);
  render::ViewSettings settings = liveSettings();
  settings.auto_exposure = true;
  settings.samples = 16;
  const render::Frame frame = stage.accumulate(kCamera, settings, 8);
  world::ChangeSet whole;
  (void)stage.world().beginTick(0.0, &whole);
  auto reference = ReferencePicture::make(renderer(), scene, std::move(whole), kCamera,
                                          render::referenceOf(settings, 3, frame.stats.exposure));
  ASSERT_TRUE(reference.ok()) << reference.error().message;
  growTo(**reference, 64);
  const auto lumaOf = [](const render::Pixels& pixels) {
    double sum = 0.0;
    for (size_t i = 0; i < size_t{pixels.width} * pixels.height; ++i) sum += metrics::luma(pixels.rgbx + 4 * i);
    return sum;
  };
  EXPECT_NEAR(lumaOf((*reference)->pixels()) / lumaOf(*frame.pixels), 1.0, 0.03);
}

}  // namespace
}  // namespace helio::test
