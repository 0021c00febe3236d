// Applying, ticks and change sets, queries.
#include <algorithm>
#include <limits>
#include <set>
#include <thread>

#include "village.h"

namespace helio::world {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

std::vector<uint32_t> slotsOf(const ChangeSet& changes) {
  std::vector<uint32_t> slots;
  for (const auto& slot : changes.slots) slots.push_back(slot.slot);
  return slots;
}

TEST(Pose, MatrixScalesTurnsAndPlaces) {
  Pose pose{{1, 2, 3}, glm::angleAxis(glm::half_pi<float>(), glm::vec3(0, 1, 0)), 2.0f};
  const glm::vec3 placed = pose.matrix() * glm::vec4(0, 0, 1, 1);  // a quarter turn about y takes z to x
  EXPECT_NEAR(placed.x, 3.0f, 1e-6f);
  EXPECT_NEAR(placed.y, 2.0f, 1e-6f);
  EXPECT_NEAR(placed.z, 3.0f, 1e-6f);
}

TEST(World, StartsAsItsScene) {
  World world(village());
  EXPECT_EQ(world.seq(), 0u);
  EXPECT_EQ(world.instanceCount(), 4u);
  EXPECT_THAT(world.prefabCounts(), ElementsAre(1, 2, 1));
  EXPECT_THAT(idsIn(world), ElementsAre(1, 2, 3, 4));
}

TEST(World, FirstChangeSetHoldsEverythingAndTheNextOnlyChanges) {
  World world(village());
  const ChangeSet first = world.beginTick(0.5);
  EXPECT_EQ(first.tick, 1u);
  EXPECT_EQ(first.applied_seq, 0u);
  EXPECT_DOUBLE_EQ(first.time, 0.5);
  EXPECT_EQ(first.slot_count, 4u);
  EXPECT_TRUE(first.environment_changed);
  EXPECT_EQ(first.environment.sky.zenith, village()->environment.sky.zenith);
  EXPECT_THAT(slotsOf(first), ElementsAre(0, 1, 2, 3));
  EXPECT_EQ(first.slots[2].instance.id, 3u);
  EXPECT_EQ(first.slots[2].instance.prefab, kHouse);
  EXPECT_EQ(first.slots[2].instance.transform[3].x, 40.0f);

  const ChangeSet second = world.beginTick(0.25);
  EXPECT_EQ(second.tick, 2u);
  EXPECT_DOUBLE_EQ(second.time, 0.75);
  EXPECT_FALSE(second.environment_changed);
  EXPECT_THAT(second.slots, IsEmpty());
}

TEST(World, ClockStandsForTimesThatAreNone) {
  World world(village());
  for (double seconds :
       {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    EXPECT_EQ(world.beginTick(seconds).time, 0.0);
  }
  EXPECT_EQ(world.beginTick(10.0).time, 10.0);
}

TEST(World, SlotsAppearOnceInTheOrderFirstTouched) {
  World world(village());
  world.beginTick(0);
  mustApply(world, {Move{4, poseAt(1, 1)}, Move{2, poseAt(2, 2)}});
  mustApply(world, {Move{4, poseAt(5, 5)}, Build{"tree", {poseAt(7, 7)}}});
  const ChangeSet changes = world.beginTick(0);
  EXPECT_EQ(changes.applied_seq, 2u);
  EXPECT_EQ(changes.slot_count, 5u);
  EXPECT_THAT(slotsOf(changes), ElementsAre(3, 1, 4));
  EXPECT_EQ(changes.slots[0].instance.transform[3].x, 5.0f);
  EXPECT_EQ(changes.slots[2].instance.id, 5u);
}

TEST(World, SlotsAreReusedIdsAreNot) {
  World world(village());
  world.beginTick(0);
  mustApply(world, {Destroy{{3}}});
  const ChangeSet freed = world.beginTick(0);
  ASSERT_THAT(slotsOf(freed), ElementsAre(2));
  EXPECT_EQ(freed.slots[0].instance.prefab, scene::kNone);

  mustApply(world, {Build{"tree", {poseAt(1, 1)}}});
  const ChangeSet reused = world.beginTick(0);
  ASSERT_THAT(slotsOf(reused), ElementsAre(2));
  EXPECT_EQ(reused.slots[0].instance.id, 5u);
  EXPECT_EQ(reused.slot_count, 4u);
  EXPECT_EQ(world.resolve(std::vector<Edit>{Destroy{{3}}}).error().kind, ErrorKind::not_found);
}

TEST(World, IdsStayUniqueOverManyGenerations) {
  World world(village());
  std::set<InstanceId> seen = {1, 2, 3, 4};
  for (int round = 0; round < 50; ++round) {
    const Batch batch = mustApply(world, {DestroyRegion{{0, 0}, 10}, Build{"tree", std::vector<Pose>(3)}});
    const auto& build = std::get<ResolvedBuild>(batch.edits[1]);
    for (InstanceId id = build.first_id; id < build.first_id + 3; ++id) EXPECT_TRUE(seen.insert(id).second) << id;
  }
  EXPECT_EQ(world.beginTick(0).slot_count, 7u);  // four of the village, three that take turns
}

TEST(World, DestroyedInstancesAreNotFound) {
  World world(village());
  mustApply(world, {Destroy{{2, 4}}});
  EXPECT_THAT(idsIn(world), ElementsAre(1, 3));
  EXPECT_THAT(world.prefabCounts(), ElementsAre(1, 1, 0));
  EXPECT_EQ(world.instanceCount(), 2u);
}

TEST(World, QueriesByTheCentreOfBoundsInPages) {
  World world(village());
  EXPECT_THAT(idsIn(world, {11, 3}, 0.1f), ElementsAre(2));
  EXPECT_THAT(idsIn(world, {0, 0}, 60), ElementsAre(1, 2, 3));
  mustApply(world, {Move{2, poseAt(-5000, -5000)}});
  EXPECT_THAT(idsIn(world, {11, 3}, 0.1f), IsEmpty());
  EXPECT_THAT(idsIn(world, {-4999, -4997}, 0.1f), ElementsAre(2));

  const auto page = [&](InstanceId after, size_t limit) {
    std::vector<InstanceId> ids;
    for (const Found& found : world.query({0, 0}, 1e6f, after, limit)) ids.push_back(found.id);
    return ids;
  };
  EXPECT_THAT(page(0, 3), ElementsAre(1, 2, 3));
  EXPECT_THAT(page(3, 3), ElementsAre(4));
  EXPECT_THAT(page(4, 3), IsEmpty());
  EXPECT_THAT(page(0, 0), IsEmpty());
}

TEST(World, QueriesThatAreNoCylinderFindNothing) {
  World world(village());
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  EXPECT_THAT(idsIn(world, {nan, 0}, 10), IsEmpty());
  EXPECT_THAT(idsIn(world, {0, inf}, 10), IsEmpty());
  EXPECT_THAT(idsIn(world, {0, 0}, -1), IsEmpty());
  EXPECT_THAT(idsIn(world, {0, 0}, inf), IsEmpty());
}

TEST(World, AppliesOnlyTheNextSequenceNumber) {
  World world(village());
  const Batch batch = *world.resolve(std::vector<Edit>{Destroy{{2}}});
  for (uint64_t seq : {uint64_t{0}, uint64_t{2}, std::numeric_limits<uint64_t>::max()}) {
    const Result<void> applied = world.apply(seq, batch);
    ASSERT_FALSE(applied.ok());
    EXPECT_EQ(applied.error().kind, ErrorKind::conflict);
    EXPECT_EQ(applied.error().field, "seq");
    EXPECT_EQ(applied.error().limit, "1");
  }
  EXPECT_EQ(world.instanceCount(), 4u);
  EXPECT_TRUE(world.apply(1, batch).ok());
  EXPECT_EQ(world.seq(), 1u);
}

TEST(World, AppliesABatchWholeOrNotAtAll) {
  const auto nan = std::numeric_limits<float>::quiet_NaN();
  const ResolvedEdit good = ResolvedDestroy{{2}};
  scene::Environment black;
  black.sky.zenith.x = -1.0f;
  const std::vector<std::pair<ResolvedEdit, std::string>> bad = {
      {ResolvedBuild{99, 5, {{}}}, "edits[1].prefab"},
      {ResolvedBuild{kHouse, 6, {{}}}, "edits[1].first_id"},
      {ResolvedBuild{kHouse, 5, {{}, poseAt(nan, 0)}}, "edits[1].poses[1].position"},
      {ResolvedDestroy{{3, 2}}, "edits[1].ids[1]"},
      {ResolvedDestroy{{5}}, "edits[1].ids[0]"},
      {ResolvedMove{99, {}}, "edits[1].id"},
      {ResolvedMove{2, {}}, "edits[1].id"},
      {ResolvedMove{3, poseAt(0, 0, 0)}, "edits[1].pose.scale"},
      {ResolvedEnvironment{black}, "edits[1].sky"},
      {ResolvedEnvironment{{{{0, 0, 0}, {}, 0.1f}, {}}}, "edits[1].sun.direction"},
  };
  World world(village());
  world.beginTick(0);
  for (const auto& [edit, field] : bad) {
    const Result<void> applied = world.apply(1, Batch{{good, edit}});
    ASSERT_FALSE(applied.ok()) << field;
    EXPECT_EQ(applied.error().field, field);
    EXPECT_EQ(world.seq(), 0u);
    EXPECT_THAT(idsIn(world), ElementsAre(1, 2, 3, 4));
    EXPECT_THAT(world.beginTick(0).slots, IsEmpty());
  }
}

TEST(World, TellsTheEnvironmentOnceItChanged) {
  World world(village());
  world.beginTick(0);
  mustApply(world, {SetSun{{{0, -2, 0}, {7, 7, 7}, 0.1f}, false}});
  const ChangeSet changes = world.beginTick(0);
  EXPECT_TRUE(changes.environment_changed);
  EXPECT_EQ(changes.environment.sun.irradiance.x, 7.0f);
  EXPECT_EQ(changes.environment.sun.direction, glm::vec3(0, -1, 0));
  EXPECT_FALSE(world.beginTick(0).environment_changed);
}

TEST(World, ReadersAndTheTickRunBesideAWriter) {
  World world(village());
  constexpr int kBatches = 300;
  std::thread writer([&] {
    for (int i = 0; i < kBatches; ++i) mustApply(world, {Build{"tree", {poseAt(float(i), 0)}}});
  });
  std::thread reader([&] {
    while (world.seq() < kBatches) {
      const auto ids = idsIn(world);
      EXPECT_TRUE(std::is_sorted(ids.begin(), ids.end()));
    }
  });
  uint64_t seen = 0;
  std::set<InstanceId> ids;
  while (seen < kBatches) {
    const ChangeSet changes = world.beginTick(0.001);
    EXPECT_GE(changes.applied_seq, seen);
    seen = changes.applied_seq;
    for (const auto& slot : changes.slots) ids.insert(slot.instance.id);
    EXPECT_EQ(ids.size(), 4 + seen);  // all edits up to applied_seq have come, and no others
  }
  writer.join();
  reader.join();
}

}  // namespace
}  // namespace helio::world
