// Samples that are no light: dropped, counted by pass and cause, and with strict numerics the end of it.
#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "render/faults.h"
#include "render/passes/accumulate.h"
#include "shaders/embedded.h"
#include "shaders/probe.h"
#include "support/scenes.h"
#include "support/stage.h"

namespace helio::test {
namespace {

using render::Mode;
using render::Primary;
using testing::HasSubstr;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInfinity = std::numeric_limits<float>::infinity();
constexpr uint32_t kSize = 64;

std::unique_ptr<render::Renderer> makeRenderer(bool strict) {
  render::RendererOptions options;
  options.device = std::getenv("HELIOGRAPH_DEVICE") ? "" : "cpu";
  options.strict_validation = std::getenv("HELIOGRAPH_TEST_WITHOUT_VALIDATION") == nullptr;
  options.strict_numerics = strict;
  auto made = render::makeRenderer(options);
  if (!made) throw std::runtime_error(made.error().message);
  return std::move(*made);
}

/// Counts faults where the process's renderer of the tests would stop.
render::Renderer& lenient() {
  static const std::unique_ptr<render::Renderer> instance = makeRenderer(false);
  return *instance;
}

render::ViewSettings settingsOf(Mode mode, Primary primary) {
  render::ViewSettings settings = referenceSettings(kSize, kSize);
  settings.mode = mode;
  settings.primary = primary;
  return settings;
}

/// A surface that shines with `radiance`, whatever that is: unlit, so that no light table knows of it.
scene::Material shining(float radiance) {
  scene::Material m;
  m.base_color = {radiance, radiance, radiance, 1.0f};
  m.unlit = true;
  return m;
}

const scene::Camera kDown = lookAt({0, 10, 0}, {0, 0, 0}, 0.8f);

/// The point below kDown that pixel (x, y) has in its middle, `height` above the ground.
glm::vec3 under(uint32_t x, uint32_t y, float height = 0.0f) {
  const float half = (10.0f - height) * std::tan(0.4f);
  const auto at = [&](uint32_t pixel) { return (2.0f * (static_cast<float>(pixel) + 0.5f) / kSize - 1.0f) * half; };
  return {at(x), height, at(y)};
}

// A quad that covers one pixel and most of it: only its samples are dropped, and the report says where.
TEST(Numerics, OnePixelIsDroppedCountedAndNamed) {
  struct Case {
    float radiance;
    const char* cause;
  };
  for (const Case& c : {Case{kNan, "NaN"}, Case{kInfinity, "infinite"}, Case{-1.0f, "negative"}}) {
    SceneBuilder b;
    b.place(b.prefab("spot", quad(0.12f), b.material(shining(c.radiance))), at(under(40, 20)));
    b.place(b.prefab("light", quad(0.12f), b.material(shining(1.0f))), at(under(7, 9)));
    for (const auto& [mode, primary] : {std::pair{Mode::reference, Primary::traced},
                                        {Mode::hybrid, Primary::traced},
                                        {Mode::hybrid, Primary::raster}}) {
      auto viewed = ViewedWorld::open(lenient(), b.build());
      ASSERT_TRUE(viewed) << viewed.error().message;
      render::ViewSettings settings = settingsOf(mode, primary);
      settings.samples = 8;
      auto frame = (*viewed)->tick(kDown, settings);
      ASSERT_TRUE(frame) << frame.error().message;
      const render::FrameStats& stats = frame->stats;
      ASSERT_EQ(stats.dropped.size(), 1u) << c.cause;
      EXPECT_EQ(stats.dropped[0].pass, "path_trace");
      EXPECT_EQ(stats.dropped[0].cause, c.cause);
      EXPECT_EQ(stats.dropped[0].samples, stats.nonfinite);
      EXPECT_GT(stats.nonfinite, 0u);
      EXPECT_LE(stats.nonfinite, 8u);
      ASSERT_TRUE(stats.first_fault);
      EXPECT_EQ(stats.first_fault->x, 40u);
      EXPECT_EQ(stats.first_fault->y, 20u);
      EXPECT_EQ(stats.first_fault->vertex, 0u);
      EXPECT_LT(stats.first_fault->sample, 8u);
      for (const float radiance : frame->radiance) ASSERT_TRUE(std::isfinite(radiance) && radiance >= 0.0f);
      EXPECT_GT(texel(*frame, 7, 9).x, 0.0f);
    }
  }
}

// What a mirror shows is found at the path's second vertex.
TEST(Numerics, TheVertexIsNamed) {
  SceneBuilder b;
  b.place(b.prefab("mirror", quad(100.0f), b.material(metal(glm::vec3(1.0f), 0.0f))));
  b.environment().sky = {glm::vec3(kNan), glm::vec3(kNan)};
  auto viewed = ViewedWorld::open(lenient(), b.build());
  ASSERT_TRUE(viewed) << viewed.error().message;
  auto frame = (*viewed)->tick(kDown, settingsOf(Mode::reference, Primary::traced));
  ASSERT_TRUE(frame) << frame.error().message;
  EXPECT_EQ(frame->stats.nonfinite, uint64_t{kSize} * kSize);
  ASSERT_TRUE(frame->stats.first_fault);
  EXPECT_EQ(frame->stats.first_fault->vertex, 1u);
  EXPECT_EQ(frame->stats.first_fault->x + frame->stats.first_fault->y, 0u) << "the first pixel, in whatever order";
}

// A factor that is no number makes a path's throughput one: it does not end quietly.
TEST(Numerics, AThroughputIsCountedToo) {
  SceneBuilder b;
  b.place(b.prefab("plane", quad(100.0f), b.material(lambert(glm::vec3(kNan)))));
  b.environment().sky = {glm::vec3(1.0f), glm::vec3(1.0f)};
  auto viewed = ViewedWorld::open(lenient(), b.build());
  ASSERT_TRUE(viewed) << viewed.error().message;
  auto frame = (*viewed)->tick(kDown, settingsOf(Mode::reference, Primary::traced));
  ASSERT_TRUE(frame) << frame.error().message;
  EXPECT_EQ(frame->stats.nonfinite, uint64_t{kSize} * kSize);
}

// Further paths of a tick are dropped and counted as its own are, and take nothing good with them: pixels whose own was
// dropped go on from those.
TEST(Numerics, FurtherPathsAreDroppedToo) {
  SceneBuilder b;
  b.place(b.prefab("plane", quad(100.0f), b.material(lambert(glm::vec3(0.5f)))));
  b.place(b.prefab("broken", quad(2.0f), b.material(shining(kNan))), at({0, 1, 0}));
  b.environment().sky = {glm::vec3(2.0f), glm::vec3(0.1f)};
  b.place(b.prefab("box", cube(), b.material(lambert(glm::vec3(0.5f)))), at({2, 0.5f, 0}));
  render::ViewSettings settings = settingsOf(Mode::hybrid, Primary::traced);
  settings.denoiser = render::Denoiser::svgf;
  settings.accumulate = false;
  uint64_t dropped[2] = {};
  for (const bool extra : {false, true}) {
    auto viewed = ViewedWorld::open(lenient(), b.build());
    ASSERT_TRUE(viewed) << viewed.error().message;
    settings.extra_samples = extra ? 2.0f : 0.0f;
    auto frame = (*viewed)->tick(lookAt({0, 3, 5}, {0, 0, 0}, 0.8f), settings);
    ASSERT_TRUE(frame) << frame.error().message;
    EXPECT_EQ(frame->stats.extra_paths > 0, extra);
    for (const float radiance : frame->radiance) ASSERT_TRUE(std::isfinite(radiance) && radiance >= 0.0f);
    dropped[extra] = frame->stats.nonfinite;
  }
  EXPECT_GT(dropped[0], 0u);
  EXPECT_GT(dropped[1], dropped[0] + dropped[0] / 4);
}

// No triangle is known that a device shows and that yet has no normal: what a primary hit's report says is read from
// counters made by hand.
TEST(Numerics, APrimaryHitIsThePrimaryPasss) {
  shared::Faults faults{};
  const uint32_t kind = shared::kFaultPrimary * shared::kFaultCauses + shared::kFaultInfinite;
  faults.counts[kind] = 3;
  faults.first_sample = ~11u;
  faults.seed = 7;
  faults.places[kind] = ~((5 * kSize + 9) << shared::kFaultVertexBits);
  render::FrameStats stats;
  render::reportFaults(faults, kSize, stats);
  ASSERT_EQ(stats.dropped.size(), 1u);
  EXPECT_EQ(stats.dropped[0].pass, "primary");
  EXPECT_EQ(stats.dropped[0].cause, "infinite");
  EXPECT_EQ(stats.dropped[0].samples, 3u);
  ASSERT_TRUE(stats.first_fault);
  EXPECT_EQ(stats.first_fault->x, 9u);
  EXPECT_EQ(stats.first_fault->y, 5u);
  EXPECT_EQ(stats.first_fault->vertex, 0u);
  EXPECT_EQ(stats.first_fault->sample, 11u);
}

// When what was broken is gone, so is all trace of it.
TEST(Numerics, NothingStays) {
  SceneBuilder b;
  b.place(b.prefab("plane", quad(100.0f), b.material(lambert(glm::vec3(0.5f)))));
  b.place(b.prefab("spot", quad(2.0f), b.material(shining(kNan))), at({0, 1, 0}));
  b.environment().sky = {glm::vec3(1.0f), glm::vec3(1.0f)};
  for (const Primary primary : {Primary::raster, Primary::traced}) {
    auto viewed = ViewedWorld::open(lenient(), b.build());
    ASSERT_TRUE(viewed) << viewed.error().message;
    const render::ViewSettings settings = settingsOf(Mode::hybrid, primary);
    for (int i = 0; i < 4; ++i) {
      auto frame = (*viewed)->tick(kDown, settings);
      ASSERT_TRUE(frame) << frame.error().message;
      EXPECT_GT(frame->stats.nonfinite, 0u);
    }
    const world::Edit destroy = world::Destroy{{2}};
    auto batch = (*viewed)->world().resolve({&destroy, 1});
    ASSERT_TRUE(batch) << batch.error().message;
    ASSERT_TRUE((*viewed)->world().apply((*viewed)->world().seq() + 1, *batch));
    auto frame = (*viewed)->tick(kDown, settings);
    ASSERT_TRUE(frame) << frame.error().message;
    EXPECT_EQ(frame->stats.nonfinite, 0u);
    for (const float radiance : frame->radiance) ASSERT_NEAR(radiance, 0.5f, 0.01f);
  }
}

TEST(Numerics, StrictStopsAtTheFirstAndSaysWhere) {
  const auto strict = makeRenderer(true);
  SceneBuilder b;
  b.place(b.prefab("spot", quad(0.12f), b.material(shining(kNan))), at(under(40, 20)));
  auto viewed = ViewedWorld::open(*strict, b.build());
  ASSERT_TRUE(viewed) << viewed.error().message;
  render::ViewSettings settings = settingsOf(Mode::hybrid, Primary::raster);
  settings.accumulate = false;
  auto frame = (*viewed)->tick(kDown, settings);
  ASSERT_FALSE(frame);
  EXPECT_EQ(frame.error().kind, ErrorKind::internal);
  const std::string& line = frame.error().message;
  EXPECT_EQ(line.find('\n'), std::string::npos);
  for (const char* part : {"path_trace found a sample that is NaN", "pixel (40, 20) of 64 x 64", "sample 0", "vertex 0",
                           "seed 0", "hybrid mode with 3 bounces"})
    EXPECT_THAT(line, HasSubstr(part));
}

// ---- Pass `accumulate` on a history that somebody broke ----

/// A view of its own, whose accumulation is no number when the next sample comes.
TEST(Numerics, ABrokenHistoryBeginsAgain) {
  gpu::DeviceOptions options;
  options.select = std::getenv("HELIOGRAPH_DEVICE") ? "" : "cpu";
  options.validation = std::getenv("HELIOGRAPH_TEST_WITHOUT_VALIDATION") == nullptr;
  auto made = gpu::Device::create(options);
  ASSERT_TRUE(made) << made.error().message;
  const std::shared_ptr<gpu::Device> device = std::move(*made);
  gpu::Commands commands(*device);
  const render::Accumulate accumulate(*device);
  render::View view(device);
  render::PathQueue paths(*device);
  const render::ViewSettings settings = settingsOf(Mode::reference, Primary::traced);
  const gpu::ComputePipeline fill_image(*device, "fill_image.comp", shaders::find("fill_image.comp"));
  const auto fill = [&](const gpu::Image& image, const glm::vec4& value) {
    commands.bind(fill_image);
    commands.push(shared::FillConstants{image.slot(), kSize, value});
    commands.dispatch(kSize / 8, kSize / 8);
  };

  commands.begin();
  view.begin(commands, kDown, settings, true, 0, 1);
  shared::FrameConstants constants{};
  constants.width = constants.height = kSize;
  constants.radiance = view.radiance.slot();
  constants.accumulation = view.accumulation.slot();
  constants.view_state = view.state.address();
  commands.upload<shared::FrameConstants>(view.constants, 0, std::span(&constants, 1));
  (void)view.nextSample();
  commands.barrier(gpu::use::everything, gpu::use::everything);
  fill(view.radiance, glm::vec4(0.25f, 0.5f, 0.75f, 1.0f));
  fill(view.accumulation, glm::vec4(1.0f, kNan, 1.0f, 7.0f));
  commands.barrier(gpu::use::everything, gpu::use::everything);
  render::Graph graph;
  const shared::SampleConstants sample = view.nextSample();
  accumulate.add({graph, view, 0, nullptr, nullptr, paths}, sample);
  graph.record(commands);
  commands.barrier(gpu::use::everything, gpu::use::everything);
  commands.copy(view.accumulation, view.radiance_readback);
  commands.copy(view.state, view.state_readback, sizeof(shared::ViewState));
  commands.barrier(gpu::use::everything, gpu::use::everything);
  commands.submit();
  (void)commands.finish();

  view.radiance_readback.invalidate();
  const auto* mean = reinterpret_cast<const glm::vec4*>(view.radiance_readback.mapped());
  for (size_t i = 0; i < size_t{kSize} * kSize; ++i) ASSERT_EQ(mean[i], glm::vec4(0.25f, 0.5f, 0.75f, 1.0f));
  view.state_readback.invalidate();
  shared::ViewState state;
  std::memcpy(&state, view.state_readback.mapped(), sizeof state);
  render::FrameStats stats;
  render::reportFaults(state.faults, kSize, stats);
  ASSERT_EQ(stats.dropped.size(), 1u);
  EXPECT_EQ(stats.dropped[0].pass, "accumulate");
  EXPECT_EQ(stats.dropped[0].cause, "NaN");
  EXPECT_EQ(stats.dropped[0].samples, uint64_t{kSize} * kSize);
  EXPECT_EQ(stats.first_fault->sample, 1u);
  EXPECT_EQ(device->validationErrors(), 0u);
}

}  // namespace
}  // namespace helio::test
