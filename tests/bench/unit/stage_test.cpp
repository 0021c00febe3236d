#include "bench/stage.h"

#include <gtest/gtest.h>

namespace helio::bench {
namespace {

/// Boxes of the given sizes, one prefab each, on a floor that cannot be moved.
scene::Scene boxes(const std::vector<float>& sizes) {
  scene::Scene scene;
  scene.name = "boxes";
  const auto place = [&](const std::string& name, float size, bool buildable) {
    scene::Mesh mesh;
    mesh.bounds.grow(glm::vec3(0.0f));
    mesh.bounds.grow(glm::vec3(size));
    const auto index = static_cast<uint32_t>(scene.meshes.size());
    scene.meshes.push_back(mesh);
    scene.prefabs.push_back({name, "box", index, buildable});
    scene.placements.push_back({index, glm::mat4x3(1.0f)});
  };
  place("floor", 0.01f, false);
  for (const float size : sizes) place("box", size, true);
  return scene;
}

TEST(Mover, IsTheSmallestThatUsersMayMove) {
  const Result<world::Move> mover = findMover(boxes({3.0f, 1.0f, 2.0f}));
  ASSERT_TRUE(mover) << mover.error().message;
  EXPECT_EQ(mover->id, 3u);  // the floor is 1
}

TEST(Mover, IsMeasuredAsItIsPlaced) {
  scene::Scene scene = boxes({1.0f, 2.0f});
  scene.placements[1].transform =
      world::Pose{{5.0f, 6.0f, 7.0f}, glm::angleAxis(1.0f, glm::vec3(0, 1, 0)), 4.0f}.matrix();
  const Result<world::Move> small = findMover(scene);
  ASSERT_TRUE(small);
  EXPECT_EQ(small->id, 3u);

  scene.placements.pop_back();
  const Result<world::Move> turned = findMover(scene);
  ASSERT_TRUE(turned);
  EXPECT_EQ(turned->id, 2u);
  EXPECT_EQ(turned->pose.position, glm::vec3(5.0f, 6.0f, 7.0f));
  EXPECT_FLOAT_EQ(turned->pose.scale, 4.0f);
  EXPECT_NEAR(glm::angle(turned->pose.rotation), 1.0f, 1e-5f);
}

// A move would straighten what no pose describes: another picture would be measured.
TEST(Mover, MustHaveAPose) {
  scene::Scene scene = boxes({1.0f, 2.0f, 3.0f});
  scene.placements[1].transform[0] *= 2.0f;   // stretched
  scene.placements[2].transform[0] *= -1.0f;  // mirrored
  const Result<world::Move> mover = findMover(scene);
  ASSERT_TRUE(mover);
  EXPECT_EQ(mover->id, 4u);

  scene.placements.pop_back();
  const Result<world::Move> none = findMover(scene);
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().kind, ErrorKind::unsupported);
}

TEST(StageOptions, TheCitysFlagsAreTheCitys) {
  StageOptions options;
  options.instances = 2000;
  EXPECT_TRUE(check(options));
  options.scene = "model.glb";
  const Result<void> checked = check(options);
  ASSERT_FALSE(checked);
  EXPECT_EQ(checked.error().kind, ErrorKind::invalid);
}

TEST(Stage, SomethingMovesEachTickAndComesBack) {
  StageOptions options;
  options.instances = 1000;
  options.camera = "city_at_sunset";
  Result<Stage> stage = Stage::open(options);
  ASSERT_TRUE(stage) << stage.error().message;
  EXPECT_EQ(stage->camera().name, "city_at_sunset");

  const Result<world::ChangeSet> first = stage->advance();
  ASSERT_TRUE(first) << first.error().message;
  EXPECT_EQ(first->slots.size(), stage->instances());
  EXPECT_EQ(first->environment.sun.direction, stage->camera().environment.sun.direction);

  Result<world::ChangeSet> before = stage->advance();
  for (int tick = 0; tick < 4; ++tick) {
    const Result<world::ChangeSet> now = stage->advance();
    ASSERT_TRUE(now) << now.error().message;
    ASSERT_EQ(now->slots.size(), 1u);
    ASSERT_EQ(now->slots[0].instance.id, before->slots[0].instance.id);
    const glm::vec3 moved = now->slots[0].instance.transform[3] - before->slots[0].instance.transform[3];
    EXPECT_NEAR(std::abs(moved.y), 0.001f, 1e-4f);
    EXPECT_EQ(moved.x, 0.0f);
    EXPECT_FALSE(now->environment_changed);
    before = now;
  }
}

TEST(Stage, AnUnknownCameraIsAnErrorThatNamesTheOthers) {
  StageOptions options;
  options.instances = 1000;
  options.camera = "nowhere";
  const Result<Stage> stage = Stage::open(options);
  ASSERT_FALSE(stage);
  EXPECT_EQ(stage.error().kind, ErrorKind::not_found);
  EXPECT_NE(stage.error().message.find("tilted_city"), std::string::npos) << stage.error().message;
}

}  // namespace
}  // namespace helio::bench
