// Levels of detail of what is drawn and of what rays meet: coarser with the distance, hardly seen, and within a budget.
#include <cmath>

#include "scene/city.h"
#include "scene/levels_of_detail.h"
#include "support/scenes.h"
#include "support/stage.h"

namespace helio::test {
namespace {

using render::Primary;

render::ViewSettings live(Primary primary, bool levels) {
  render::ViewSettings settings;
  settings.width = 160;
  settings.height = 90;
  settings.primary = primary;
  settings.bounces = 0;
  settings.accumulate = false;
  settings.auto_exposure = false;
  settings.levels_of_detail = levels;
  return settings;
}

/// Balls of `rings` rings with levels, from 3 m to `farthest` m away, on a plane under the sun.
scene::ScenePtr balls(uint32_t rings = 24, uint32_t count = 60, float farthest = 200.0f) {
  SceneBuilder builder;
  builder.environment().sun = {glm::normalize(glm::vec3(-0.4f, -1.0f, -0.5f)), glm::vec3(3.0f), 0.01f};
  builder.environment().sky = {glm::vec3(0.4f), glm::vec3(0.4f)};
  const uint32_t ball = builder.prefab("ball", sphere(rings), builder.material(lambert(glm::vec3(0.6f, 0.5f, 0.4f))));
  const uint32_t ground = builder.prefab("ground", quad(600.0f), builder.material(lambert(glm::vec3(0.5f))));
  builder.place(ground, at({0, -1, 0}));
  for (uint32_t i = 0; i < count; ++i) {
    const float away = 3.0f * std::pow(farthest / 3.0f, static_cast<float>(i) / static_cast<float>(count));
    builder.place(ball, at({away * 0.5f * std::sin(2.4f * static_cast<float>(i)), 0, -away}));
  }
  scene::Scene scene = *builder.build();
  scene::makeLevels(scene.meshes[0], scene.materials, scene::Seams::keep);
  return std::make_shared<scene::Scene>(std::move(scene));
}

const scene::Camera kCamera = lookAt({0, 1.5f, 3.0f}, {0, 0.0f, -20.0f}, 0.9f);

double relativeDifference(const render::Frame& a, const render::Frame& b) {
  double difference = 0.0, sum = 0.0;
  for (size_t i = 0; i < a.radiance.size(); ++i) {
    difference += std::abs(static_cast<double>(a.radiance[i]) - static_cast<double>(b.radiance[i]));
    sum += static_cast<double>(b.radiance[i]);
  }
  return difference / sum;
}

TEST(Detail, FewerTrianglesAndTheSamePicture) {
  const scene::ScenePtr scene = balls();
  for (const Primary primary : {Primary::raster, Primary::traced}) {
    Stage fine(scene), coarse(scene);
    render::ViewSettings with = live(primary, true), without = live(primary, false);
    with.keep_radiance = without.keep_radiance = true;
    const render::Frame a = coarse.tick(kCamera, with), b = fine.tick(kCamera, without);
    showPicture(a, "detail_coarse");
    showPicture(b, "detail_fine");
    if (primary == Primary::raster) {
      EXPECT_LT(a.stats.triangles_drawn, b.stats.triangles_drawn / 3);
      EXPECT_GT(b.stats.triangles_drawn, 60'000u);
    }
    EXPECT_LT(relativeDifference(a, b), 0.03);
    EXPECT_GT(relativeDifference(a, b), 0.0);  // the test can see levels
  }
}

TEST(Detail, NoShadowsWhereTheRasterisersLevelIsNotTheBlases) {
  // A picture of few pixels makes levels coarse. The next one is drawn finer at once, while the budget of a tick leaves
  // rays with the coarse levels of some.
  const scene::ScenePtr scene = balls(48, 600, 12.0f);
  Stage stage(scene);
  render::ViewSettings tiny = live(Primary::raster, true), fine = live(Primary::raster, true);
  tiny.width = tiny.height = 16;
  fine.width = 160;
  fine.height = 90;
  fine.keep_radiance = true;
  const scene::Camera close = lookAt({0, 1.5f, 3.0f}, {0, 0.0f, -20.0f}, 0.04f);
  const auto picture = [&](bool levels) {
    Stage stage(scene);
    tiny.levels_of_detail = fine.levels_of_detail = levels;
    (void)stage.tick(kCamera, tiny);
    const render::Frame frame = stage.tick(close, fine);
    const uint32_t left = stage.tick(close, fine).stats.acceleration.levels_switched;
    EXPECT_EQ(left > 0, levels);  // some were left to this tick
    return frame;
  };
  const render::Frame a = picture(true), b = picture(false);
  showPicture(a, "detail_gap");
  showPicture(b, "detail_no_gap");
  EXPECT_LT(std::abs(mean(a).g / mean(b).g - 1.0f), 0.01f);
  EXPECT_LT(relativeDifference(a, b), 0.03);
}

TEST(Detail, SwitchesStayWithinTheirBudgetAndEnd) {
  const scene::ScenePtr scene = *scene::generateCity({1, 10'000, 0});
  Stage stage(scene);
  render::ViewSettings settings = live(Primary::traced, true);
  settings.width = settings.height = 16;
  scene::Camera camera = scene->cameras.front().camera;
  camera.vfov = 0.02f;  // so that pixels are small
  const render::Frame first = stage.tick(camera, settings);
  EXPECT_EQ(first.stats.acceleration.levels_switched, 0u);  // instances come at the right levels
  const scene::Camera back = camera;
  camera.position += glm::vec3(600.0f, 60.0f, 500.0f);
  uint64_t switched = 0;
  uint32_t ticks = 0;
  for (; ticks < 40; ++ticks) {
    const render::Frame frame = stage.tick(camera, settings);
    EXPECT_LE(frame.stats.acceleration.levels_switched, 4096u);
    EXPECT_EQ(frame.stats.tlas_instances, first.stats.tlas_instances);
    switched += frame.stats.acceleration.levels_switched;
    if (frame.stats.acceleration.levels_switched == 0) break;
  }
  EXPECT_GT(switched, 500u);
  EXPECT_LT(ticks, 30u);
  // A reference view has the finest at once.
  render::ViewSettings reference = referenceSettings(16, 16);
  Stage fresh(scene);
  const render::Frame a = stage.tick(back, reference), b = fresh.tick(back, reference);
  EXPECT_EQ(bytes(a), bytes(b));
}

TEST(Detail, TheSameTicksGiveTheSameBytes) {
  const scene::ScenePtr scene = balls();
  const auto run = [&] {
    Stage stage(scene);
    std::vector<uint8_t> all;
    scene::Camera camera = kCamera;
    for (int tick = 0; tick < 4; ++tick, camera.position.z -= 15.0f) {
      const std::vector<uint8_t> picture = bytes(stage.tick(camera, live(Primary::raster, true)));
      all.insert(all.end(), picture.begin(), picture.end());
    }
    return all;
  };
  EXPECT_EQ(run(), run());
}

TEST(Detail, DistantWalkersHaveCoarseBlases) {
  scene::Scene scene = **scene::generateCity({1, 1'000, 100});
  scene.placements.clear();
  scene.routes.clear();
  const uint32_t walker = scene.findPrefab("walker_smith");
  for (int i = 0; i < 10; ++i) scene.placements.push_back({walker, at({static_cast<float>(i) - 5.0f, 0, 0})});
  const auto shared = std::make_shared<scene::Scene>(std::move(scene));
  const uint64_t finest = shared->meshes[shared->prefabs[walker].mesh].indices.size() / 3;
  Stage stage(shared);
  const auto trianglesFrom = [&](float away, bool levels) {
    const render::Frame frame = stage.tick(lookAt({0, 2, away}, {0, 1, 0}, 0.9f), live(Primary::traced, levels));
    EXPECT_EQ(frame.stats.acceleration.own_blases, 10u);
    return frame.stats.acceleration.blas_triangles;
  };
  EXPECT_EQ(trianglesFrom(1.5f, false), 10 * finest);
  EXPECT_LT(trianglesFrom(160.0f, true), finest);  // all ten together
  EXPECT_EQ(trianglesFrom(160.0f, false), 10 * finest);
}

}  // namespace
}  // namespace helio::test
