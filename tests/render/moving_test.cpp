// What moves looks the same to the rasteriser, to rays and to the CPU; it comes and goes without a trace.
#include <algorithm>
#include <cmath>
#include <random>

#include "scene/city.h"
#include "scene/deform.h"
#include "support/scenes.h"
#include "support/stage.h"

namespace helio::test {
namespace {

using render::Primary;
using scene::kNone;

render::ViewSettings live(Primary primary) {
  render::ViewSettings settings;
  settings.width = 240;
  settings.height = 135;
  settings.primary = primary;
  settings.bounces = 0;
  settings.accumulate = false;
  settings.auto_exposure = false;
  settings.levels_of_detail = false;
  return settings;
}

/// The city's prefabs without its placements. `flat`: every material shines with a colour of its own, so that pixels
/// say what they show and nothing else.
scene::Scene workshop(bool flat) {
  static const scene::ScenePtr city = *scene::generateCity({1, 1'000, 100});
  scene::Scene scene = *city;
  scene.placements.clear();
  scene.routes.clear();
  if (!flat) return scene;
  scene.textures.clear();
  for (size_t m = 0; m < scene.materials.size(); ++m) {
    scene::Material plain;
    plain.unlit = true;
    const auto channel = [m](size_t prime) { return 0.05f + 0.9f * static_cast<float>(m * prime % 97) / 97.0f; };
    plain.base_color = {channel(31), channel(57), channel(83), 1.0f};
    scene.materials[m] = plain;
  }
  scene.environment = {};
  return scene;
}

/// Walkers on a circle, a car among them, a turning mill, and a house fitted to a slope.
scene::ScenePtr parade(bool flat) {
  scene::Scene scene = workshop(flat);
  std::vector<glm::vec3> ring;
  for (int i = 0; i < 48; ++i) {
    const float angle = 6.2831853f * static_cast<float>(i) / 48.0f;
    ring.emplace_back(4.0f * std::cos(angle), 0.0f, 4.0f * std::sin(angle));
  }
  scene.routes = {scene::Route(ring)};
  const float length = scene.routes[0].length();
  std::vector<uint32_t> walkers;
  for (uint32_t p = 0; p < scene.prefabs.size(); ++p)
    if (scene.prefabs[p].category == "walker") walkers.push_back(p);
  walkers.push_back(scene.findPrefab("vehicle_car_a"));
  for (size_t i = 0; i < walkers.size(); ++i) {
    scene::Placement placed;
    placed.prefab = walkers[i];
    placed.route = 0;
    placed.route_start = length * static_cast<float>(i) / static_cast<float>(walkers.size());
    placed.route_speed = 1.2f;
    placed.transform = scene.routes[0].at(static_cast<double>(placed.route_start));
    scene.placements.push_back(placed);
  }
  scene.placements.push_back({scene.findPrefab("windmill_turning"), at({-12.0f, 0.0f, -22.0f})});
  for (uint32_t p = 0; p < scene.prefabs.size(); ++p) {
    if (!(scene.meshes[scene.prefabs[p].mesh].fit_height > 0.0f)) continue;
    scene.placements.push_back({p, at({12.0f, 0.0f, -18.0f})});
    break;
  }
  scene.ground = {{-100.0f, -100.0f}, 200.0f, 2, {8.0f, -8.0f, 8.0f, -8.0f}};
  return std::make_shared<scene::Scene>(std::move(scene));
}

const scene::Camera kParadeCamera = lookAt({1.0f, 3.0f, 11.0f}, {0, 1.4f, 0}, 0.85f);

/// The share of pixels that differ by more than `most`.
double difference(const render::Frame& a, const render::Frame& b, int most = 4) {
  const std::vector<uint8_t> x = bytes(a), y = bytes(b);
  size_t different = 0;
  for (size_t i = 0; i < x.size(); i += 4) {
    int furthest = 0;
    for (size_t c = 0; c < 3; ++c) furthest = std::max(furthest, std::abs(x[i + c] - y[i + c]));
    different += furthest > most;
  }
  return static_cast<double>(different) / (static_cast<double>(x.size()) / 4.0);
}

TEST(Moving, RasterisedAndTracedPicturesAgreeWhileEverythingMoves) {
  const scene::ScenePtr scene = parade(true);
  Stage rasterised(scene), traced(scene);
  for (int tick = 0; tick < 20; ++tick) {  // past the turn in which BLASes are rebuilt
    const bool compared = tick == 0 || tick > 14;
    for (Stage* stage : {&rasterised, &traced}) stage->setStep(compared ? 1.0 / 60.0 : 0.11);
    const render::Frame a = rasterised.tick(kParadeCamera, live(Primary::raster));
    const render::Frame b = traced.tick(kParadeCamera, live(Primary::traced));
    EXPECT_EQ(a.stats.nonfinite + b.stats.nonfinite, 0u);
    if (!compared) continue;
    const double share = difference(a, b);
    showPicture(a, "moving_raster_" + std::to_string(tick));
    showPicture(b, "moving_traced_" + std::to_string(tick));
    // An edge may fall on either side of a pixel's centre: the rasteriser snaps vertices to 1/256 of a pixel.
    EXPECT_LT(share, 0.002) << "tick " << tick;
    // All that moves is brought to this tick's pose; the fitted house was built once.
    const render::AccelerationUse& use = b.stats.acceleration;
    EXPECT_EQ(use.blases_built + use.blases_refitted, tick == 0 ? use.own_blases : use.own_blases - 1)
        << "tick " << tick;
  }
}

TEST(Moving, RasterisedAndTracedPicturesOfCoarserLevelsAgree) {
  const scene::ScenePtr scene = parade(true);
  Stage rasterised(scene), traced(scene), exact(scene);
  render::ViewSettings raster = live(Primary::raster), rays = live(Primary::traced);
  raster.levels_of_detail = rays.levels_of_detail = true;
  scene::Camera camera = kParadeCamera;  // from twice as far, for levels are half a pixel off
  camera.position *= 2.0f;
  for (int tick = 0; tick < 3; ++tick) {
    const render::Frame a = rasterised.tick(camera, raster), b = traced.tick(camera, rays),
                        c = exact.tick(camera, live(Primary::traced));
    EXPECT_LT(a.stats.triangles_drawn, 12'000u);
    EXPECT_LT(b.stats.acceleration.blas_triangles, c.stats.acceleration.blas_triangles * 2 / 3);
    EXPECT_LT(difference(a, b), 0.004) << "tick " << tick;  // the margin at which levels switch
    EXPECT_LT(difference(b, c), 0.02) << "tick " << tick;   // a pixel off along edges
    EXPECT_GT(difference(b, c), 0.0) << "tick " << tick;
  }
}

TEST(Moving, StandsInThePoseThatTheCpuFinds) {
  scene::Scene moving = workshop(true);
  const uint32_t walker = moving.findPrefab("walker_smith"), mill = moving.findPrefab("windmill_turning");
  moving.placements = {{walker, at({-0.6f, 0, 0})}, {mill, at({2.0f, -8.0f, -9.0f})}};
  // The walker plays its gait on the spot.
  moving.prefabs[walker].clip = moving.prefabs[walker].travel_clip;
  moving.prefabs[walker].out_of_step = moving.prefabs[mill].out_of_step = false;
  scene::Scene still = moving;
  constexpr double kTime = 0.37;
  for (const uint32_t p : {walker, mill}) {
    scene::Prefab& prefab = still.prefabs[p];
    scene::Mesh& mesh = still.meshes[prefab.mesh];
    const scene::Rig& rig = still.rigs[prefab.rig];
    mesh.positions = scene::deformedPositions(mesh, rig, rig.clips[prefab.clip], static_cast<float>(kTime));
    mesh.skin.clear();
    prefab.rig = kNone;
  }
  const scene::Camera camera = lookAt({0.5f, 1.5f, 4.0f}, {0.2f, 1.2f, 0}, 0.8f);
  for (const Primary primary : {Primary::raster, Primary::traced}) {
    Stage a(std::make_shared<scene::Scene>(moving)), b(std::make_shared<scene::Scene>(still));
    a.setStep(kTime);
    const render::Frame posed = a.tick(camera, live(primary)), baked = b.tick(camera, live(primary));
    showPicture(posed, "posed");
    showPicture(baked, "baked");
    EXPECT_LT(difference(posed, baked), 0.002);
    a.setStep(0.2);
    EXPECT_GT(difference(a.tick(camera, live(primary)), baked), 0.01);  // the test can see a pose
  }
}

TEST(Moving, APausedWorldRefitsNothingAndALongStepIsAStepLikeOthers) {
  Stage stage(parade(false));
  const render::ViewSettings settings = live(Primary::traced);
  (void)stage.tick(kParadeCamera, settings);
  stage.setStep(0.0);
  const render::Frame first = stage.tick(kParadeCamera, settings), second = stage.tick(kParadeCamera, settings);
  EXPECT_EQ(second.stats.acceleration.blases_refitted + second.stats.acceleration.blases_built, 0u);
  EXPECT_EQ(second.stats.acceleration.own_blases, first.stats.acceleration.own_blases);
  EXPECT_GT(second.stats.acceleration.own_blases, 10u);
  EXPECT_FALSE(recorded(second, "tlas"));
  stage.setStep(10.0);
  const render::Frame later = stage.tick(kParadeCamera, settings);
  EXPECT_GT(later.stats.acceleration.blases_refitted, 0u);
  EXPECT_EQ(later.stats.nonfinite, 0u);
}

TEST(Moving, SeekingBackShowsTheSamePicture) {
  Stage stage(parade(true));
  const render::ViewSettings settings = live(Primary::raster);
  stage.edit({world::SetTime{.paused = true, .rate = {}, .seek = 3.0}});
  const render::Frame before = stage.tick(kParadeCamera, settings);
  stage.edit({world::SetTime{.paused = {}, .rate = {}, .seek = 500.0}});
  EXPECT_GT(difference(before, stage.tick(kParadeCamera, settings)), 0.01);
  stage.edit({world::SetTime{.paused = {}, .rate = {}, .seek = 3.0}});
  EXPECT_EQ(difference(before, stage.tick(kParadeCamera, settings), 0), 0.0);
}

/// A triangle on one joint that does what `channel` says.
scene::ScenePtr oneBone(const scene::Channel& channel, float duration, size_t count = 1) {
  SceneBuilder builder;
  scene::Mesh mesh = quad(1.0f);
  mesh.skin.resize(mesh.positions.size());
  const uint32_t prefab = builder.prefab("bone", std::move(mesh), builder.material(lambert(glm::vec3(0.5f))));
  builder.environment().sky = {glm::vec3(1.0f), glm::vec3(1.0f)};
  scene::Scene scene = *builder.build();
  scene::Rig rig;
  rig.nodes.resize(1);
  rig.joints = {{0, glm::mat4x3(1.0f)}};
  rig.clips = {{"clip", duration, {channel}}};
  scene.rigs = {rig};
  scene.prefabs[prefab].rig = 0;
  scene.placements.assign(count, {prefab, at({0, 0, 0})});
  return std::make_shared<scene::Scene>(std::move(scene));
}

TEST(Moving, DegenerateAndMirroredBonesAndSingleKeysGiveNumbers) {
  using scene::ChannelTarget, scene::Interpolation;
  const std::vector<scene::Channel> channels = {
      {0, ChannelTarget::scale, Interpolation::linear, {0.0f, 1.0f}, {1, 1, 1, -1, -1, -1}},  // through a point
      {0, ChannelTarget::scale, Interpolation::step, {0.0f}, {0, 1, 1}},                      // flat, one key
      {0, ChannelTarget::rotation, Interpolation::linear, {0.0f, 1.0f}, {0, 0, 0, 0, 0, 0, 0, 0}},
      {0, ChannelTarget::translation, Interpolation::linear, {0.25f}, {0, 0.5f, 0}},
      {0, ChannelTarget::scale, Interpolation::linear, {0.0f, 1.0f}, {1, 1, 1, 3e38f, 3e38f, 3e38f}},
  };
  const scene::Camera camera = lookAt({0.3f, 2.0f, 0.4f}, {0, 0, 0}, 0.8f);
  for (size_t i = 0; i < channels.size(); ++i) {
    Stage stage(oneBone(channels[i], 1.0f));
    stage.setStep(0.25);
    for (int tick = 0; tick < 5; ++tick)
      for (const Primary primary : {Primary::raster, Primary::traced})
        EXPECT_EQ(stage.tick(camera, live(primary)).stats.nonfinite, 0u) << "channel " << i << ", tick " << tick;
  }
}

TEST(Moving, TenThousandUnitsAtOneSpot) {
  const scene::Channel slide{
      0, scene::ChannelTarget::translation, scene::Interpolation::linear, {0, 1}, {0, 0, 0, 0, 1, 0}};
  Stage stage(oneBone(slide, 1.0f, 10'000));
  const scene::Camera camera = lookAt({0.3f, 3.0f, 0.4f}, {0, 0, 0}, 0.8f);
  render::ViewSettings settings = live(Primary::traced);
  settings.width = settings.height = 16;
  render::Frame frame = stage.tick(camera, settings);
  EXPECT_EQ(frame.stats.acceleration.own_blases, 1024u);  // the budget of a tick
  EXPECT_EQ(frame.stats.acceleration.own_blases_waiting, 10'000u - 1024u);
  for (int tick = 1; tick < 10; ++tick) frame = stage.tick(camera, settings);
  EXPECT_EQ(frame.stats.acceleration.own_blases, 10'000u);
  EXPECT_EQ(frame.stats.acceleration.own_blases_waiting, 0u);
  EXPECT_EQ(frame.stats.nonfinite, 0u);
}

TEST(Moving, WhatIsDestroyedWhileItsBlasIsBuiltLeavesNothing) {
  Stage stage(parade(false));
  const render::ViewSettings settings = live(Primary::traced);
  const render::Frame before = stage.tick(kParadeCamera, settings);
  const uint64_t base = stage.world().instanceCount();
  const auto build = [&](uint32_t count) {
    stage.edit({world::Build{"walker_maid", std::vector<world::Pose>(count)}});
  };
  // In the same tick; and in the tick after the one whose builds the budget cut short.
  build(50);
  stage.edit({world::DestroyRegion{{0, 0}, 1.0f}});
  EXPECT_EQ(stage.tick(kParadeCamera, settings).stats.acceleration.own_blases, before.stats.acceleration.own_blases);
  build(1'500);
  const render::Frame during = stage.tick(kParadeCamera, settings);
  EXPECT_GT(during.stats.acceleration.own_blases_waiting, 0u);
  stage.edit({world::DestroyRegion{{0, 0}, 1.0f}});
  const render::Frame after = stage.tick(kParadeCamera, settings);
  EXPECT_EQ(stage.world().instanceCount(), base);
  EXPECT_EQ(after.stats.acceleration.own_blases, before.stats.acceleration.own_blases);
  EXPECT_EQ(after.stats.acceleration.own_blas_bytes, before.stats.acceleration.own_blas_bytes);
  EXPECT_EQ(after.stats.acceleration.own_vertex_bytes, before.stats.acceleration.own_vertex_bytes);
  EXPECT_EQ(after.stats.tlas_instances, before.stats.tlas_instances);
}

TEST(Moving, AThousandRandomCommandsLeaveMemoryAsItWas) {
  Stage stage(parade(false));
  render::ViewSettings settings = live(Primary::traced);
  settings.width = settings.height = 32;
  (void)stage.tick(kParadeCamera, settings);
  const render::Frame before = stage.tick(kParadeCamera, settings);
  std::mt19937 random(20261122);
  const auto below = [&](uint32_t n) { return std::uniform_int_distribution<uint32_t>(0, n - 1)(random); };
  const std::vector<std::string> kinds = {"walker_maid", "walker_elder", "vehicle_van", "windmill_turning",
                                          "walker_child"};
  std::vector<world::InstanceId> built;
  world::InstanceId last_id = stage.world().instanceCount();  // base placements have ids 1 to N
  for (int command = 0; command < 1'000; ++command) {
    if (built.size() < 300 && below(2) == 0) {
      std::vector<world::Pose> poses(1 + below(12));
      for (world::Pose& pose : poses)
        pose.position = {static_cast<float>(below(40)) - 20.0f, 0.0f, static_cast<float>(below(40)) - 20.0f};
      stage.edit({world::Build{kinds[below(static_cast<uint32_t>(kinds.size()))], poses}});
      for (size_t i = 0; i < poses.size(); ++i) built.push_back(++last_id);
    } else if (!built.empty()) {
      std::shuffle(built.begin(), built.end(), random);
      const size_t count = std::min<size_t>(built.size(), 1 + below(12));
      stage.edit({world::Destroy{{built.end() - static_cast<std::ptrdiff_t>(count), built.end()}}});
      built.resize(built.size() - count);
    }
    if (command % 25 == 24) (void)stage.tick(kParadeCamera, settings);
  }
  if (!built.empty()) stage.edit({world::Destroy{built}});
  render::Frame after;
  for (int tick = 0; tick < 3; ++tick) after = stage.tick(kParadeCamera, settings);
  const auto expectSame = [](uint64_t was, uint64_t is, const char* what) {
    EXPECT_LT(std::abs(static_cast<double>(is) - static_cast<double>(was)), 0.01 * static_cast<double>(was)) << what;
  };
  EXPECT_EQ(after.stats.tlas_instances, before.stats.tlas_instances);
  expectSame(before.stats.memory.raster, after.stats.memory.raster, "raster");
  expectSame(before.stats.memory.ray_tracing, after.stats.memory.ray_tracing, "ray tracing");
  expectSame(before.stats.acceleration.total(), after.stats.acceleration.total(), "acceleration structures");
}

TEST(Culling, FrustumAndRadiusLeaveOutWhatIsFarBehind) {
  scene::Scene scene = workshop(true);
  const uint32_t walker = scene.findPrefab("walker_smith"), house = scene.findPrefab("windmill");
  for (int i = 0; i < 300; ++i) {
    const float x = 5.0f * static_cast<float>(i % 20) - 50.0f;
    const float z = i < 150 ? -20.0f - static_cast<float>(i) : 1'000.0f + static_cast<float>(i);
    scene.placements.push_back({i % 3 == 0 ? walker : house, at({x, 0, z})});
  }
  const auto shared = std::make_shared<scene::Scene>(std::move(scene));
  const scene::Camera camera = lookAt({0, 12, 30}, {0, 2, -60}, 0.9f);
  Stage full(shared), culled(shared);
  culled.setCulling(render::Culling::frustum_radius);
  const render::Frame a = full.tick(camera, live(Primary::traced)), b = culled.tick(camera, live(Primary::traced));
  EXPECT_EQ(a.stats.tlas_instances, 300u);
  EXPECT_EQ(b.stats.tlas_instances, 150u);
  EXPECT_EQ(a.stats.acceleration.own_blases, 100u);
  EXPECT_EQ(b.stats.acceleration.own_blases, 50u);
  EXPECT_LT(b.stats.acceleration.tlas_bytes, a.stats.acceleration.tlas_bytes);
  EXPECT_LT(difference(a, b), 0.0005);  // what the camera sees is all there

  // A camera that turns round finds everything in its frustum at once.
  const scene::Camera back = lookAt({0, 12, 30}, {0, 2, 1'100}, 0.9f);
  const render::Frame c = full.tick(back, live(Primary::traced)), d = culled.tick(back, live(Primary::traced));
  EXPECT_EQ(d.stats.tlas_instances, 300u);  // those behind are within 800 m now
  EXPECT_LT(difference(c, d), 0.0005);

  // A reference view knows no approximation.
  render::ViewSettings reference = referenceSettings();
  EXPECT_EQ(culled.tick(camera, reference).stats.tlas_instances, 300u);
}

}  // namespace
}  // namespace helio::test
