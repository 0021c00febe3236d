// Light by lobe adds up to the picture, and what SVGF makes of it is near the truth, whatever happens to camera and
// world.
#include <algorithm>
#include <functional>

#include "denoise/pictures.h"
#include "support/likeness.h"

namespace helio::test {
namespace {

using render::Denoiser;
using render::Inspect;
using render::Primary;

const scene::Camera kCamera = lookAt({0.4f, 1.6f, 4.2f}, {0, 0.6f, 0});

TEST(Split, LightByLobeTimesAlbedosAddsUpToThePicture) {
  for (const scene::ScenePtr& scene : {stillLife(), lampRoom(), sunlitPatch()}) {
    for (const uint32_t samples : {1u, 3u}) {
      Stage whole(scene), apart(scene);
      // Rasterised, so that all samples of a tick see the same points.
      render::ViewSettings settings = live(Denoiser::none, Primary::raster);
      settings.samples = samples;
      const render::Frame expected = whole.tick(kCamera, settings);
      settings.inspect = Inspect::unfiltered;
      const render::Frame found = apart.tick(kCamera, settings);
      size_t wrong = 0;
      for (size_t i = 0; i < expected.radiance.size(); ++i) {
        // Each part is rounded to 9 bits of its light's largest channel, some thrice; what reflects that one least
        // shows most.
        const float* pixel = &expected.radiance[i / 3 * 3];
        const float largest = std::max({pixel[0], pixel[1], pixel[2]});
        wrong += !(std::abs(found.radiance[i] - expected.radiance[i]) <= 2e-2f * largest + 1e-5f);
      }
      // Variants of a shader round differently: some path somewhere decides differently.
      EXPECT_LE(wrong, expected.radiance.size() / 1000) << samples << " samples a tick";
    }
  }
}

TEST(Split, LightIsWithoutTheAlbedo) {
  // Lambert of any colour under a sky of radiance 1: what arrives is 1, and nothing of it by a specular lobe.
  SceneBuilder builder;
  scene::Texture checks{"checks", 8, 8, {}, true};
  for (uint32_t i = 0; i < 64; ++i)
    checks.rgba.insert(checks.rgba.end(), {static_cast<uint8_t>(40 + 3 * i), 120, 60, 255});
  scene::Material textured = lambert(glm::vec3(1.0f));
  textured.base_color_texture = builder.texture(checks);
  builder.place(builder.prefab("floor", quad(4.0f), builder.material(textured)));
  builder.environment().sky = {glm::vec3(1.0f), glm::vec3(1.0f)};
  Stage stage(builder.build());
  const scene::Camera above = lookAt({0, 1.5f, 0}, {0, 0, 0});
  render::ViewSettings settings = live(Denoiser::svgf);
  settings.inspect = Inspect::diffuse;
  settings.roulette = false;
  for (const float value : stage.tick(above, settings).radiance) ASSERT_NEAR(value, 1.0f, 0.01f);
  settings.inspect = Inspect::specular;
  for (const float value : stage.tick(above, settings).radiance) ASSERT_EQ(value, 0.0f);
}

TEST(Svgf, IsNearTheTruthAtRest) {
  struct Case {
    const char* name;
    scene::ScenePtr scene;
    double better;  // than one sample, after 8 ticks
  };
  // What is left of the second case's error are edges: the truth smooths them, one position a pixel does not.
  for (const auto& [name, scene, better] :
       {Case{"lamp_room", lampRoom(), 20.0}, Case{"sunlit_patch", sunlitPatch(), 5.0}}) {
    const render::Frame reference = truth(scene, kCamera);
    Stage raw(scene), denoised(scene);
    const double noise = relativeMse(raw.tick(kCamera, live(Denoiser::none)), reference);
    render::Frame frame;
    for (int tick = 1; tick <= 32; ++tick) {
      frame = denoised.tick(kCamera, live(Denoiser::svgf));
      EXPECT_EQ(brokenTexels(frame), 0u);
      if (tick != 1 && tick != 8 && tick != 32) continue;
      const double error = relativeMse(frame, reference);
      std::printf("%s, tick %d: relative MSE %.5f of %.4f (1/%.0f), similarity %.3f\n", name, tick, error, noise,
                  noise / error, structuralSimilarity(*frame.pixels, *reference.pixels));
      EXPECT_LT(error, noise / (tick == 1 ? 0.4 * better : better)) << name << ", tick " << tick;
      EXPECT_NEAR(mean(frame).y / mean(reference).y, 1.0f, 0.08f) << name << ", tick " << tick;
    }
    showPicture(frame, std::string("svgf_") + name);
    showPicture(reference, std::string("truth_") + name);
    EXPECT_GT(structuralSimilarity(*frame.pixels, *reference.pixels), 0.7);  // the truth has noise of its own
  }
}

TEST(Svgf, APictureThatStandsStillConverges) {
  const scene::ScenePtr scene = lampRoom();
  render::ViewSettings settings = live(Denoiser::svgf, Primary::raster);  // the same positions in the pixel
  settings.width = settings.height = 24;
  settings.bounces = 0;  // little noise is left of so many samples
  settings.accumulate = true;
  settings.samples = 64;
  Stage denoised(scene);
  const render::Frame end = denoised.accumulate(kCamera, settings, 18);  // beyond 1024 samples
  settings.denoiser = Denoiser::none;
  Stage plain(scene);
  const render::Frame expected = plain.accumulate(kCamera, settings, 18);
  EXPECT_LT(relativeMse(end, expected), 2e-3);
  settings.denoiser = Denoiser::svgf;
  settings.samples = 1;
  Stage early(scene);
  EXPECT_GT(relativeMse(early.accumulate(kCamera, settings, 18), expected),
            5e-3);  // the test can see what filters leave
}

/// All denoisers must bear what is done to histories.
class Histories : public testing::TestWithParam<Denoiser> {};
INSTANTIATE_TEST_SUITE_P(Denoise, Histories, testing::Values(Denoiser::svgf, Denoiser::asvgf, Denoiser::reblur),
                         [](const auto& p) {
                           return p.param == Denoiser::svgf ? "svgf" : p.param == Denoiser::asvgf ? "asvgf" : "reblur";
                         });

// A small sun in a mirror behind the camera: one diffuse ray in some ten thousand finds it, and brings thousands of
// times the light.
TEST_P(Histories, FirefliesDoNotStayInThem) {
  SceneBuilder b;
  b.place(b.prefab("ground", quad(40.0f), b.material(lambert(glm::vec3(0.6f)))));
  b.place(b.prefab("mirror", quad(8.0f), b.material(metal(glm::vec3(0.95f), 0.0f))),
          glm::mat4x3({0, 1, 0}, {-1, 0, 0}, {0, 0, 1}, {6, 4, 0}));
  b.environment().sun = {glm::normalize(glm::vec3(1.0f, -1.0f, 0.0f)), glm::vec3(3.0f), 0.02f};
  b.environment().sky = {glm::vec3(0.3f), glm::vec3(0.3f)};
  const scene::ScenePtr scene = b.build();
  Stage stage(scene), bare(scene);
  float brightest = 0.0f, raw = 0.0f, usual = 0.0f;
  const auto most = [](const render::Frame& frame) {
    return *std::max_element(frame.radiance.begin(), frame.radiance.end());
  };
  const scene::Camera camera = lookAt({-1.0f, 3.0f, 3.0f}, {1.0f, 0, 0});
  for (int tick = 0; tick < 24; ++tick) {
    const render::Frame frame = stage.tick(camera, live(GetParam()));
    raw = std::max(raw, most(bare.tick(camera, live(Denoiser::none))));
    brightest = std::max(brightest, most(frame));
    usual = mean(frame).y;
    if (tick == 23) showPicture(frame, "fireflies");
  }
  std::printf("brightest raw %.1f, denoised %.2f, mean %.3f\n", raw, brightest, usual);
  EXPECT_GT(raw, 500.0f * usual);
  EXPECT_LT(brightest, 2.0f * usual);
}

TEST_P(Histories, WhatIsBrokenInThemDoesNotSpread) {
  Stage stage(lampRoom());
  render::ViewSettings settings = live(GetParam());
  const render::Frame before = stage.accumulate(kCamera, settings, 6);
  settings.poison_history = true;
  const render::Frame after = stage.tick(kCamera, settings);
  EXPECT_EQ(brokenTexels(after), 0u);
  EXPECT_NEAR(mean(after).y / mean(before).y, 1.0f, 0.15f);
  settings.poison_history = false;
  settings.inspect = Inspect::samples;
  const render::Frame samples = stage.tick(kCamera, settings);  // all of them began again
  for (size_t i = 0; i < samples.radiance.size(); i += 3) ASSERT_LE(samples.radiance[i], 2.0f);
}

TEST(Svgf, GathersSamplesAlongTheMotionOfTheCamera) {
  Stage stage(sunlitPatch());
  render::ViewSettings settings = live(Denoiser::svgf);
  render::Frame frame;
  for (int tick = 0; tick < 8; ++tick) {
    settings.inspect = tick == 7 ? Inspect::samples : Inspect::nothing;
    const float t = 0.02f * static_cast<float>(tick);
    frame = stage.tick(lookAt({0.4f + t, 1.6f, 4.2f}, {t, 0.6f, 0}), settings);
  }
  size_t surfaces = 0, followed = 0;
  for (size_t i = 0; i < frame.radiance.size(); i += 3) {
    surfaces += frame.radiance[i] > 0.0f;
    followed += frame.radiance[i] > 6.5f;
  }
  EXPECT_GT(static_cast<double>(followed), 0.85 * static_cast<double>(surfaces));
}

TEST_P(Histories, HardOnesLeaveNumbers) {
  struct Change {
    const char* name;
    std::function<void(Stage&, scene::Camera&, render::ViewSettings&)> make;
  };
  const std::vector<Change> changes = {
      {"jump",
       [](Stage&, scene::Camera& camera, render::ViewSettings&) {
         camera = lookAt({60.0f, 9.0f, 40.0f}, {0, 0, 0});
       }},
      {"inside a box",
       [](Stage&, scene::Camera& camera, render::ViewSettings&) {
         camera.position = {-0.9f, 0.7f, -0.7f};
       }},
      {"resize",
       [](Stage&, scene::Camera&, render::ViewSettings& settings) { settings.width /= 2, settings.height /= 2; }},
      {"exposure up", [](Stage&, scene::Camera&, render::ViewSettings& settings) { settings.exposure_ev = 10.0f; }},
      {"exposure down", [](Stage&, scene::Camera&, render::ViewSettings& settings) { settings.exposure_ev = -10.0f; }},
      {"no time", [](Stage& stage, scene::Camera&, render::ViewSettings&) { stage.setStep(0.0); }},
      {"ten seconds", [](Stage& stage, scene::Camera&, render::ViewSettings&) { stage.setStep(10.0); }},
      {"raster", [](Stage&, scene::Camera&, render::ViewSettings& settings) { settings.primary = Primary::raster; }},
      {"off and on", [](Stage& stage, scene::Camera& camera, render::ViewSettings& settings) {
         render::ViewSettings off = settings;
         off.denoiser = Denoiser::none;
         off.taa = false;
         EXPECT_EQ(stage.tick(camera, off).stats.history_bytes, 0u);
       }}};
  for (const Change& change : changes) {
    Stage stage(lampRoom());
    scene::Camera camera = kCamera;
    render::ViewSettings settings = live(GetParam());
    settings.taa = true;
    const render::Frame before = stage.accumulate(camera, settings, 4);
    change.make(stage, camera, settings);
    for (int tick = 0; tick < 2; ++tick) {
      const render::Frame after = stage.tick(camera, settings);
      EXPECT_EQ(brokenTexels(after), 0u) << change.name;
      EXPECT_EQ(after.stats.nonfinite, 0u) << change.name;
      EXPECT_EQ(after.radiance.size(), size_t{3} * settings.width * settings.height) << change.name;
      if (camera.position == kCamera.position) {  // it is the same room
        EXPECT_NEAR(mean(after).y / mean(before).y, 1.0f, 0.15f) << change.name;
      }
    }
  }
}

TEST(Svgf, LightsThatGoOutGoDark) {
  Stage stage(sunlitPatch());
  const render::ViewSettings settings = live(Denoiser::svgf);
  const render::Frame before = stage.accumulate(kCamera, settings, 16);
  scene::Environment night;
  night.sky = {glm::vec3(0.0f), glm::vec3(0.0f)};
  night.sun.irradiance = glm::vec3(0.0f);
  ASSERT_TRUE(stage.world().apply(stage.world().seq() + 1, {{world::ResolvedEnvironment{night}}}));
  const render::Frame after = stage.accumulate(kCamera, settings, 64);
  EXPECT_EQ(brokenTexels(after), 0u);
  EXPECT_LT(mean(after).y, 0.5f * mean(before).y);  // a lamp is left
}

TEST(Svgf, CostsNothingUnlessAskedForAndRepeatsItself) {
  Stage stage(lampRoom());
  const render::Frame off = stage.tick(kCamera, live(Denoiser::none));
  for (const char* pass : {"motion", "svgf_temporal", "svgf_variance", "svgf_atrous"})
    EXPECT_FALSE(recorded(off, pass));
  EXPECT_EQ(off.stats.history_bytes, 0u);
  std::vector<uint8_t> first;
  for (int run = 0; run < 2; ++run) {
    Stage again(lampRoom());
    const render::Frame frame = again.accumulate(kCamera, live(Denoiser::svgf), 3);
    EXPECT_TRUE(recorded(frame, "svgf_atrous"));
    if (run == 0) first = bytes(frame);
    else EXPECT_EQ(bytes(frame), first);
    std::printf("SVGF keeps %.1f MB at 1920 x 1080\n", historyMegabytes(frame));
    EXPECT_LE(historyMegabytes(frame), kMostMegabytes);
  }
  render::ViewSettings wrong = live(Denoiser::none);
  wrong.inspect = Inspect::diffuse;
  EXPECT_FALSE(render::check(wrong));
}

}  // namespace
}  // namespace helio::test
