// Further paths after a jump: samples where the variance is high.
#include <functional>

#include "denoise/pictures.h"
#include "support/hypothesis.h"

namespace helio::test {
namespace {

using render::Denoiser;
using render::Inspect;

constexpr double kPixels = kPictureWidth * kPictureHeight;
const scene::Camera kCamera = lookAt({0, 2.6f, 7.0f}, {0, 0.9f, 0});
const scene::Camera kRoomCamera = lookAt({0.4f, 1.6f, 4.2f}, {0, 0.6f, 0});

/// Left of a wall a ground in plain sun; right of it, under a roof, a wide lamp above bars.
scene::ScenePtr halfNoisy() {
  SceneBuilder b;
  const uint32_t grey = b.material(lambert(glm::vec3(0.6f)));
  const uint32_t box = b.prefab("box", cube(), grey);
  b.place(b.prefab("ground", quad(40.0f), grey));
  const auto slab = [&](const glm::vec3& position, const glm::vec3& size) {
    glm::mat4x3 m(1.0f);
    m[0] = {size.x, 0, 0};
    m[1] = {0, size.y, 0};
    m[2] = {0, 0, size.z};
    m[3] = position;
    b.place(box, m);
  };
  slab({0, 2, 0}, {0.1f, 4, 8});  // between the halves
  slab({3, 4, 0}, {6, 0.1f, 8});  // the roof
  slab({6, 2, 0}, {0.1f, 4, 8});
  slab({3, 2, -4}, {6, 4, 0.1f});
  slab({1.6f, 0.4f, -1}, {0.8f, 0.8f, 0.8f});
  slab({-2, 0.4f, -1}, {0.8f, 0.8f, 0.8f});
  b.place(b.prefab("lamp", quad(4.0f), b.material(lambert(glm::vec3(0.0f), glm::vec3(1.5f)))), at({3, 3.8f, -1}));
  for (int bar = 0; bar < 8; ++bar) slab({3, 2.8f, -3.0f + 0.5f * static_cast<float>(bar)}, {5, 0.05f, 0.25f});
  b.environment().sun = {glm::normalize(glm::vec3(-0.4f, -1.0f, -0.5f)), glm::vec3(3.0f), 0.00935f};
  return b.build();
}

render::ViewSettings withExtra(float extra, Denoiser denoiser = Denoiser::svgf) {
  render::ViewSettings settings = live(denoiser);
  settings.extra_samples = extra;
  settings.bounces = 1;
  return settings;
}
/// The light of a tick before any denoiser; nothing is gathered, so all of it is young in every tick.
render::ViewSettings unfiltered(float extra) {
  render::ViewSettings settings = withExtra(extra, Denoiser::none);
  settings.inspect = Inspect::unfiltered;
  return settings;
}
render::ViewSettings withTwoSamples(render::ViewSettings settings) {
  settings.samples = 2;
  return settings;
}

/// The mean of many ticks: what one tick would show if it had all paths there are.
render::Frame expectedLight(const scene::ScenePtr& scene, const scene::Camera& camera) {
  Stage stage(scene);
  stage.setStep(0.0);
  render::ViewSettings settings = unfiltered(0.0f);
  settings.samples = 16;
  constexpr int kTicks = 32;
  render::Frame sum = stage.tick(camera, settings);
  for (int tick = 1; tick < kTicks; ++tick) {
    const render::Frame frame = stage.tick(camera, settings);
    for (size_t i = 0; i < sum.radiance.size(); ++i) sum.radiance[i] += frame.radiance[i];
  }
  for (float& value : sum.radiance) value /= kTicks;
  return sum;
}

/// Mean error of a frame after so many ticks from a cold start, over several with random numbers of their own.
double errorAfter(const scene::ScenePtr& scene, const scene::Camera& camera, const render::ViewSettings& settings,
                  const render::Frame& expected, uint32_t ticks, uint32_t runs = 12) {
  Stage stage(scene);
  stage.setStep(0.0);
  double sum = 0.0;
  for (uint32_t run = 0; run < runs; ++run) {
    stage.tick(camera, live(Denoiser::none));  // what was gathered is gone
    const render::Frame frame = stage.accumulate(camera, settings, ticks);
    EXPECT_EQ(brokenTexels(frame), 0u);
    sum += relativeMse(frame, expected);
    if (run == 0)
      showPicture(frame,
                  "cold_start_" + std::to_string(settings.samples) + "_" + std::to_string(settings.extra_samples));
  }
  return sum / runs;
}

// As many paths as two a pixel, but where they help: the noise of a tick's light, then the first frame's error.
TEST(ColdStart, PathsGoWhereTheNoiseIs) {
  const scene::ScenePtr scene = halfNoisy();
  const render::Frame expected = expectedLight(scene, kCamera);
  showPicture(expected, "cold_start_expected");
  const double once = errorAfter(scene, kCamera, unfiltered(0.0f), expected, 1),
               twice = errorAfter(scene, kCamera, withTwoSamples(unfiltered(0.0f)), expected, 1),
               extra = errorAfter(scene, kCamera, unfiltered(1.0f), expected, 1);
  std::printf("noise of one path a pixel %.4f, of two %.4f, of one and one more in the mean %.4f\n", once, twice,
              extra);
  EXPECT_LT(extra, 0.5 * once);
  EXPECT_LT(extra, 0.85 * twice);
}

TEST(ColdStart, TheFirstFrameIsBetter) {
  for (const auto& [name, scene, camera] :
       {std::tuple{"half noisy", halfNoisy(), kCamera}, std::tuple{"lamp room", lampRoom(), kRoomCamera}}) {
    const render::Frame expected = expectedLight(scene, camera);
    for (const Denoiser denoiser : {Denoiser::svgf, Denoiser::asvgf, Denoiser::reblur}) {
      const double none = errorAfter(scene, camera, withExtra(0.0f, denoiser), expected, 1),
                   twice = errorAfter(scene, camera, withTwoSamples(withExtra(0.0f, denoiser)), expected, 1),
                   extra = errorAfter(scene, camera, withExtra(1.0f, denoiser), expected, 1),
                   fourth = errorAfter(scene, camera, withExtra(0.0f, denoiser), expected, 4, 6),
                   extra_fourth = errorAfter(scene, camera, withExtra(1.0f, denoiser), expected, 4, 6);
      std::printf("%s, denoiser %d: first frame %.4f, with two samples %.4f, with one more %.4f; fourth %.4f, %.4f\n",
                  name, static_cast<int>(denoiser), none, twice, extra, fourth, extra_fourth);
      EXPECT_LT(extra, 0.9 * none) << name;
      EXPECT_LT(extra, 1.03 * twice) << name;
      EXPECT_LT(extra_fourth, fourth) << name;
    }
  }
}

TEST(ColdStart, NoMorePathsThanWereAskedFor) {
  const scene::ScenePtr scene = lampRoom();
  for (const float extra : {0.25f, 1.0f, 2.0f}) {
    Stage with(scene), without(scene);
    with.setStep(0.0);
    without.setStep(0.0);
    render::ViewSettings settings = withExtra(extra), plain = withExtra(0.0f);
    settings.bounces = plain.bounces = 0;  // the ray that a surface sends on: one a path
    settings.roulette = plain.roulette = false;
    settings.path_launches = plain.path_launches = extra == 1.0f ? 1 : 0;
    for (int tick = 0; tick < 8; ++tick) {
      const render::FrameStats a = with.tick(kRoomCamera, settings).stats, b = without.tick(kRoomCamera, plain).stats;
      const auto paths = static_cast<double>(a.extra_paths);
      const double rays = static_cast<double>(a.rays.bounce) - static_cast<double>(b.rays.bounce);
      EXPECT_EQ(b.extra_paths, 0u);
      if (tick < 4) {
        EXPECT_NEAR(paths, static_cast<double>(extra) * kPixels, 0.02 * kPixels) << tick;
        EXPECT_LE(rays, paths) << tick;
        EXPECT_GT(rays, 0.9 * paths) << tick;  // rough metals swallow a few
      } else {                                 // what has been gathered is no longer young
        EXPECT_EQ(a.extra_paths, 0u) << tick;
        EXPECT_EQ(rays, 0.0) << tick;
      }
      EXPECT_EQ(a.rays.primary, b.rays.primary);
    }
  }
}

TEST(ColdStart, NoPixelHasMoreThanFiveAndSkiesHaveNone) {
  Stage stage(stillLife());  // its sky has no surface to sample
  const render::Frame frame = stage.tick(lookAt({0, 2.5f, 6}, {0, 3.5f, 0}), withExtra(4.0f));
  EXPECT_GT(frame.stats.extra_paths, 0u);
  EXPECT_LT(static_cast<double>(frame.stats.extra_paths), 3.0 * kPixels);
}

// Off, there is no pass and no memory for it; on, working memory alone.
TEST(ColdStart, CostsNothingWhereNobodyAsks) {
  const scene::ScenePtr scene = lampRoom();
  Stage off(scene), on(scene);
  const render::Frame without = off.tick(kRoomCamera, withExtra(0.0f)), with = on.tick(kRoomCamera, withExtra(1.0f));
  for (const char* pass : {"extra_samples", "extra_paths"}) {
    EXPECT_FALSE(recorded(without, pass));
    EXPECT_TRUE(recorded(with, pass));
  }
  EXPECT_EQ(with.stats.history_bytes, without.stats.history_bytes);
  const uint64_t most = static_cast<uint64_t>(5.0 * kPixels) + 1024;
  EXPECT_GT(with.stats.memory.working_set, without.stats.memory.working_set);
  EXPECT_LT(with.stats.memory.working_set, without.stats.memory.working_set + most);
}

/// Texels of so many ticks of one stage; the first ones differ in nothing but their random numbers.
Batches ticksOf(const scene::ScenePtr& scene, const render::ViewSettings& settings, int ticks) {
  Stage stage(scene);
  stage.setStep(0.0);
  Batches batches;
  for (int tick = 0; tick < ticks; ++tick) {
    const render::Frame frame = stage.tick(kCamera, settings);
    batches.emplace_back(frame.radiance.begin(), frame.radiance.end());
  }
  return batches;
}

// The light of a tick has the same mean, however its paths are shared out: that follows what the neighbours' samples
// were. (Where a pixel's own had a say, the picture was 0.3 % too dark.)
TEST(ColdStart, FurtherPathsChangeNoMean) {
  const scene::ScenePtr scene = halfNoisy();
  constexpr int kTicks = 384;
  render::ViewSettings plain = unfiltered(0.0f), extra = unfiltered(1.0f);
  plain.sampler = extra.sampler = render::Sampler::independent;
  const Batches a = ticksOf(scene, plain, kTicks), b = ticksOf(scene, extra, kTicks);
  const uint32_t row = 3 * kPictureWidth;
  const std::vector<double> whole = welch(blocks(a, row, 1 << 16), blocks(b, row, 1 << 16)),
                            parts = welch(blocks(a, row, 27), blocks(b, row, 27));
  double of_a = 0.0, of_b = 0.0;
  for (const double value : means(a)) of_a += value;
  for (const double value : means(b)) of_b += value;
  std::printf("with further paths %.4f of the light, p %.3f\n", of_b / of_a, whole.front());
  EXPECT_GT(whole.front(), 0.01);
  EXPECT_EQ(passing(parts, 0.01), 1.0);
}

// A view that moves knows what is old.
TEST(ColdStart, OnlyWhatIsNewIsYoungWhereAViewMoves) {
  const scene::ScenePtr scene = lampRoom();
  for (const Denoiser denoiser : {Denoiser::svgf, Denoiser::asvgf}) {
    Stage stage(scene);
    stage.setStep(0.0);
    render::ViewSettings settings = withExtra(1.0f, denoiser);
    settings.taa = true;
    uint64_t first = 0, last = 0;
    for (int tick = 0; tick < 16; ++tick) {
      const float along = 0.004f * static_cast<float>(std::min(tick, 11));
      const render::Frame frame = stage.tick(lookAt({0.4f + along, 1.6f, 4.2f}, {along, 0.6f, 0}), settings);
      EXPECT_EQ(brokenTexels(frame), 0u);
      if (tick == 0) first = frame.stats.extra_paths;
      if (tick == 11) last = frame.stats.extra_paths;
      // At rest edges come and go with the jitter, which is no news.
      if (tick > 11) { EXPECT_EQ(frame.stats.extra_paths, 0u) << tick; }
    }
    std::printf("further paths a pixel: %.3f, in motion %.3f\n", static_cast<double>(first) / kPixels,
                static_cast<double>(last) / kPixels);
    EXPECT_LT(static_cast<double>(last), 0.25 * static_cast<double>(first));
    EXPECT_GT(last, 0u);  // at the picture's border and behind edges
  }
}

// Hits are counted of one path a pixel.
TEST(ColdStart, GuidedCullingCountsNoFurtherPaths) {
  const scene::ScenePtr scene = stillLife();
  const auto hits = [&](float extra) {
    Stage stage(scene);
    stage.setCulling(render::Culling::lipac);
    stage.setStep(0.0);
    stage.accumulate(lookAt({0, 2.5f, 6}, {0, 0.5f, 0}), withExtra(extra), 4);
    const auto culled = renderer().culledInstances(stage.handle());
    EXPECT_TRUE(culled);
    std::vector<double> list;
    for (const render::CulledInstance& each : *culled) list.push_back(each.hits);
    return list;
  };
  EXPECT_EQ(hits(0.0f), hits(2.0f));
}

TEST(ColdStart, WhatDoesNotGoTogetherIsRefusedByName) {
  struct Case {
    const char* field;
    std::function<void(render::ViewSettings&)> change;
  };
  const std::vector<Case> cases = {
      {"settings.extra_samples", [](auto& s) { s.extra_samples = -0.5f; }},
      {"settings.extra_samples", [](auto& s) { s.extra_samples = 4.5f; }},
      {"settings.extra_samples", [](auto& s) { s.denoiser = Denoiser::none; }},
      {"settings.samples", [](auto& s) { s.samples = 2; }},
      {"settings.indirect_rate", [](auto& s) { s.indirect_rate = render::IndirectRate::half; }},
  };
  EXPECT_TRUE(render::check(withExtra(1.0f)));
  for (const Case& each : cases) {
    render::ViewSettings settings = withExtra(1.0f);
    each.change(settings);
    const auto valid = render::check(settings);
    ASSERT_FALSE(valid) << each.field;
    EXPECT_EQ(valid.error().field, each.field) << valid.error().message;
  }
  // Reference mode takes none.
  Stage stage(lampRoom());
  render::ViewSettings reference = referenceSettings(32, 32);
  reference.extra_samples = 1.0f;
  EXPECT_EQ(stage.tick(kRoomCamera, reference).stats.extra_paths, 0u);
}

}  // namespace
}  // namespace helio::test
