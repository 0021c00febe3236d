// World time: pause, rate and seek are edits like others, and survive as others do.
#include <limits>

#include "village.h"

namespace helio::world {
namespace {

using ::testing::HasSubstr;

TEST(WorldTime, RunsAtItsRateAndStandsWhilePaused) {
  World world(village());
  EXPECT_EQ(world.beginTick(2.0).time, 2.0);
  mustApply(world, {SetTime{.paused = {}, .rate = 0.5, .seek = {}}});
  EXPECT_EQ(world.beginTick(2.0).time, 3.0);
  mustApply(world, {SetTime{.paused = true, .rate = {}, .seek = {}}});
  EXPECT_EQ(world.beginTick(10.0).time, 3.0);
  EXPECT_EQ(world.beginTick(0.0).time, 3.0);
  mustApply(world, {SetTime{.paused = false, .rate = 0.0, .seek = {}}});
  EXPECT_EQ(world.beginTick(10.0).time, 3.0);
}

TEST(WorldTime, SeeksForwardsAndBackAlsoWhilePaused) {
  World world(village());
  world.beginTick(100.0);
  mustApply(world, {SetTime{.paused = {}, .rate = {}, .seek = 5.0}});
  EXPECT_EQ(world.beginTick(1.0).time, 6.0);
  mustApply(world, {SetTime{.paused = true, .rate = {}, .seek = 1e9}});
  EXPECT_EQ(world.beginTick(1.0).time, 1e9);
  mustApply(world, {SetTime{.paused = false, .rate = {}, .seek = 0.0}, SetTime{.paused = {}, .rate = 2.0, .seek = {}}});
  EXPECT_EQ(world.beginTick(1.0).time, 2.0);
}

TEST(WorldTime, IsReplayedAsItWas) {
  World original(village()), replayed(village());
  const std::vector<std::vector<Edit>> history = {
      {SetTime{.paused = {}, .rate = 3.0, .seek = {}}},
      {Build{"house", {poseAt(1, 2)}}},
      {SetTime{.paused = {}, .rate = {}, .seek = 0.5}},
      {Build{"tree", {poseAt(3, 4)}}, SetTime{.paused = true, .rate = {}, .seek = {}}}};
  for (const auto& edits : history) {
    original.beginTick(1.25);
    const std::string bytes = encode(mustApply(original, edits));
    ASSERT_TRUE(replayed.apply(replayed.seq() + 1, *decode(bytesOf(bytes))).ok());
    EXPECT_EQ(replayed.time(), original.time());
  }
  EXPECT_EQ(replayed.checksum(), original.checksum());
  EXPECT_EQ(replayed.beginTick(1.0).time, 0.5 + 3.0 * 1.25);
}

TEST(WorldTime, IsSavedAndRestored) {
  World world(village()), restored(village());
  mustApply(world, {SetTime{.paused = true, .rate = 0.25, .seek = 42.0}});
  ASSERT_TRUE(restored.restore(world.save()).ok());
  EXPECT_EQ(restored.clock().time, 42.0);
  EXPECT_EQ(restored.clock().rate, 0.25);
  EXPECT_TRUE(restored.clock().paused);
  EXPECT_EQ(restored.checksum(), world.checksum());
}

TEST(WorldTime, TheChecksumTellsClocksApartThatPeopleSet) {
  World a(village()), b(village());
  a.beginTick(7.0);
  EXPECT_EQ(a.checksum(), b.checksum());  // a running clock is nobody's doing
  mustApply(a, {SetTime{.paused = {}, .rate = 2.0, .seek = {}}});
  EXPECT_NE(a.checksum(), b.checksum());
  mustApply(b, {SetTime{.paused = {}, .rate = 2.0, .seek = {}}});
  EXPECT_EQ(a.checksum(), b.checksum());
  mustApply(a, {SetTime{.paused = true, .rate = {}, .seek = 1.0}});
  mustApply(b, {SetTime{.paused = true, .rate = {}, .seek = 2.0}});
  EXPECT_NE(a.checksum(), b.checksum());
}

TEST(WorldTime, RefusesWhatIsNoTimeByName) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  World world(village());
  const auto messageOf = [&](const SetTime& set) {
    const auto batch = world.resolve(std::vector<Edit>{SetSun{{{0, -1, 0}, {1, 1, 1}, 0.01f}, true}, set});
    return batch.ok() ? std::string("accepted") : batch.error().message;
  };
  EXPECT_THAT(messageOf({}), HasSubstr("edits[1].set_time is empty: give paused, rate or seek"));
  EXPECT_THAT(messageOf({.paused = {}, .rate = -1.0, .seek = {}}), HasSubstr("edits[1].set_time.rate is -1"));
  EXPECT_THAT(messageOf({.paused = {}, .rate = 101.0, .seek = {}}), HasSubstr("[0, 100]"));
  EXPECT_THAT(messageOf({.paused = {}, .rate = {}, .seek = nan}), HasSubstr("edits[1].set_time.seek is nan"));
  EXPECT_THAT(messageOf({.paused = {}, .rate = {}, .seek = -0.5}), HasSubstr("[0, 1000000000] seconds"));
  EXPECT_FALSE(world.apply(1, {{ResolvedTime{{nan, 1.0, false}}}}).ok());
  EXPECT_EQ(world.seq(), 0u);
}

}  // namespace
}  // namespace helio::world
