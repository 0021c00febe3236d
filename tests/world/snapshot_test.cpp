// Worlds as bytes, and the checksum that tells them apart.
#include <cstring>

#include "village.h"

namespace helio::world {
namespace {

using ::testing::HasSubstr;

/// A world that has seen every kind of edit: base instances moved and destroyed, built ones kept, moved and destroyed.
std::unique_ptr<World> livedIn() {
  auto world = std::make_unique<World>(village());
  world->beginTick(1.5);
  const Batch built = mustApply(*world, {Build{"house", {poseAt(1, 2, 3), poseAt(4, 5), poseAt(7, 8)}}});
  const InstanceId first = std::get<ResolvedBuild>(built.edits[0]).first_id;
  mustApply(*world, {Destroy{{2, first + 1}}, Move{3, poseAt(-9, 9)}, Move{first, poseAt(2, 2, 2)}});
  mustApply(*world, {SetSun{{{1, -1, 0}, {1, 1, 1}, 0.1f}, true}});
  world->beginTick(0.5);
  return world;
}

void expectSame(const World& a, const World& b) {
  EXPECT_EQ(a.seq(), b.seq());
  EXPECT_EQ(a.checksum(), b.checksum());
  EXPECT_EQ(a.instanceCount(), b.instanceCount());
  EXPECT_EQ(a.prefabCounts(), b.prefabCounts());
  EXPECT_EQ(idsIn(a), idsIn(b));
}

TEST(Snapshot, ARestoredWorldIsTheSameAndGoesOnTheSame) {
  const auto original = livedIn();
  World restored(village());
  const Result<void> done = restored.restore(original->save());
  ASSERT_TRUE(done.ok()) << done.error().message;
  expectSame(*original, restored);

  // The next ids and the clock continue.
  for (World* world : {original.get(), &restored}) mustApply(*world, {Build{"tree", {poseAt(0, 0)}}});
  expectSame(*original, restored);
  const ChangeSet a = original->beginTick(1.0), b = restored.beginTick(1.0);
  EXPECT_EQ(a.tick, b.tick);
  EXPECT_EQ(a.time, b.time);
  EXPECT_EQ(b.time, 3.0);
  EXPECT_EQ(a.environment.sun.direction, b.environment.sun.direction);
  EXPECT_EQ(b.slots.size(), b.slot_count);  // the renderer hears of everything
  EXPECT_EQ(original->save().bytes, restored.save().bytes);
}

TEST(Snapshot, HoldsWhatUsersDidAndNotTheScene) {
  const World untouched(village());
  const size_t empty = untouched.save().bytes.size();
  World world(village());
  mustApply(world, {Build{"tree", std::vector<Pose>(10)}});
  EXPECT_EQ(world.save().bytes.size(), empty + 10 * (8 + 4 + 12 * 4));
}

TEST(Snapshot, IsRefusedWhereSomethingHasHappened) {
  const Saved saved = livedIn()->save();
  World world(village());
  mustApply(world, {Destroy{{2}}});
  EXPECT_EQ(world.restore(saved).error().kind, ErrorKind::conflict);
  EXPECT_EQ(world.seq(), 1u);
}

TEST(Snapshot, OfAnotherSceneOrSeqIsRefused) {
  const Saved saved = livedIn()->save();
  auto larger = std::make_shared<scene::Scene>(*village());
  larger->placements.push_back(larger->placements.back());
  World other(larger), same(village());
  EXPECT_THAT(other.restore(saved).error().message, HasSubstr("a scene of 4 instances, this one has 5"));
  EXPECT_EQ(same.restore({saved.seq + 1, saved.bytes}).error().kind, ErrorKind::damaged);
  EXPECT_EQ(same.restore({saved.seq, "\x09" + saved.bytes.substr(1)}).error().kind, ErrorKind::unsupported);
}

TEST(Snapshot, CutAnywhereOrWithAByteMoreItIsDamaged) {
  const Saved saved = livedIn()->save();
  for (size_t length = 0; length < saved.bytes.size(); ++length) {
    World world(village());
    const Result<void> done = world.restore({saved.seq, saved.bytes.substr(0, length)});
    ASSERT_FALSE(done.ok()) << length;
    EXPECT_EQ(done.error().kind, ErrorKind::damaged);
    EXPECT_EQ(world.seq(), 0u);
  }
  World world(village());
  EXPECT_FALSE(world.restore({saved.seq, saved.bytes + "x"}).ok());
}

TEST(Snapshot, WithAnyByteWrongItIsRefusedOrAWorldThatStillWorks) {
  const Saved saved = livedIn()->save();
  for (size_t at = 0; at < saved.bytes.size(); ++at) {
    Saved wrong = saved;
    wrong.bytes[at] = static_cast<char>(wrong.bytes[at] ^ 0xff);
    World world(village());
    if (!world.restore(wrong)) continue;
    idsIn(world);
    world.beginTick(1.0);
    EXPECT_TRUE(world.resolve(std::vector<Edit>{Build{"tree", {poseAt(0, 0)}}}).ok());
  }
}

TEST(Checksum, DependsOnWhatIsThereAndNotOnHowItCameAbout) {
  World one(village()), two(village());
  EXPECT_EQ(one.checksum(), two.checksum());
  mustApply(one, {Move{2, poseAt(5, 5)}, Move{3, poseAt(6, 6)}});
  EXPECT_NE(one.checksum(), two.checksum());
  mustApply(two, {Move{3, poseAt(6, 6)}});
  mustApply(two, {Move{2, poseAt(1, 1)}});
  EXPECT_NE(one.checksum(), two.checksum());
  mustApply(two, {Move{2, poseAt(5, 5)}});
  EXPECT_EQ(one.checksum(), two.checksum());
}

TEST(Checksum, DiffersByIdPlaceAndLight) {
  std::vector<uint64_t> sums;
  for (const std::vector<Edit>& edits : {std::vector<Edit>{Destroy{{2}}},
                                         {Destroy{{3}}},
                                         {Move{2, poseAt(10, 1)}},
                                         {Move{3, poseAt(10, 1)}},
                                         {SetSun{{{1, -1, 0}, {1, 1, 1}, 0.1f}, false}},
                                         {Build{"tree", {poseAt(0, 0)}}},
                                         {Build{"house", {poseAt(0, 0)}}}}) {
    World world(village());
    mustApply(world, edits);
    EXPECT_THAT(sums, ::testing::Not(::testing::Contains(world.checksum())));
    sums.push_back(world.checksum());
  }
}

}  // namespace
}  // namespace helio::world
