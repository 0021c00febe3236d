// The log's bytes: round trips, refusals, and random damage.
#include <cstring>
#include <random>

#include "village.h"

namespace helio::world {
namespace {

using ::testing::HasSubstr;

const std::string kClock(16, '\0');  // tick 0, time 0

Batch everyKind() {
  Pose turned{{1, -2, 3.5f}, glm::quat(0.5f, -0.5f, 0.5f, 0.5f), 0.25f};
  scene::Environment environment{{{0, -1, 0}, {1, 2, 3}, 0.4f}, {{4, 5, 6}, {7, 8, 9}}};
  return {{ResolvedBuild{kHouse, 5, {turned, {}}}, ResolvedDestroy{{2, 5}}, ResolvedDestroy{}, ResolvedMove{3, turned},
           ResolvedEnvironment{environment}, ResolvedTime{{12.5, 0.25, true}}},
          17,
          2.5};
}

TEST(Codec, RoundTrips) {
  const Batch batch = everyKind();
  const Result<Batch> again = decode(bytesOf(encode(batch)));
  ASSERT_TRUE(again.ok()) << again.error().message;
  ASSERT_EQ(again->edits.size(), batch.edits.size());
  EXPECT_EQ(again->tick, 17u);
  EXPECT_EQ(again->time, 2.5);

  const auto& build = std::get<ResolvedBuild>(again->edits[0]);
  EXPECT_EQ(build.prefab, kHouse);
  EXPECT_EQ(build.first_id, 5u);
  EXPECT_TRUE(build.poses == std::get<ResolvedBuild>(batch.edits[0]).poses);
  EXPECT_EQ(std::get<ResolvedDestroy>(again->edits[1]).ids, (std::vector<InstanceId>{2, 5}));
  EXPECT_TRUE(std::get<ResolvedDestroy>(again->edits[2]).ids.empty());
  EXPECT_EQ(std::get<ResolvedMove>(again->edits[3]).id, 3u);
  EXPECT_TRUE(std::get<ResolvedMove>(again->edits[3]).pose == std::get<ResolvedMove>(batch.edits[3]).pose);
  const scene::Environment& environment = std::get<ResolvedEnvironment>(again->edits[4]).environment;
  EXPECT_EQ(environment.sun.irradiance, glm::vec3(1, 2, 3));
  EXPECT_EQ(environment.sun.angular_diameter, 0.4f);
  EXPECT_EQ(environment.sky.zenith, glm::vec3(4, 5, 6));
  EXPECT_EQ(environment.sky.ground, glm::vec3(7, 8, 9));
  const Clock& clock = std::get<ResolvedTime>(again->edits[5]).clock;
  EXPECT_EQ(clock.time, 12.5);
  EXPECT_EQ(clock.rate, 0.25);
  EXPECT_TRUE(clock.paused);
}

TEST(Codec, TheVersionIsTheLowestThatHoldsTheEdits) {
  const std::string old_kinds = encode({{ResolvedDestroy{{7}}}, 1, 0.5});
  const std::string with_time = encode({{ResolvedTime{{0.5, 1.0, false}}}, 1, 0.5});
  EXPECT_EQ(old_kinds[0], 1);
  EXPECT_EQ(with_time[0], 2);
  EXPECT_EQ(decode(bytesOf("\x02" + old_kinds.substr(1))).error().kind, ErrorKind::damaged);
  EXPECT_EQ(decode(bytesOf("\x01" + with_time.substr(1))).error().kind, ErrorKind::damaged);
}

TEST(Codec, BytesAreWhatTheFormatSays) {
  const std::string expected(
      "\x01"
      "\x03\x00\x00\x00\x00\x00\x00\x00"
      "\x00\x00\x00\x00\x00\x00\xf8\x3f"
      "\x01\x00\x00\x00"
      "\x02"
      "\x01\x00\x00\x00"
      "\x08\x07\x06\x05\x04\x03\x02\x01",
      34);
  EXPECT_EQ(encode({{ResolvedDestroy{{0x0102030405060708}}}, 3, 1.5}), expected);
}

TEST(Codec, ApplyingDecodedBatchesGivesTheSameWorld) {
  World original(village()), replayed(village());
  const std::vector<std::vector<Edit>> history = {
      {Build{"house", {poseAt(1, 2, 3), poseAt(4, 5, 6)}}, Move{2, poseAt(9, 9)}},
      {DestroyRegion{{5, 5}, 10}, SetSun{{{1, -1, 0}, {1, 1, 1}, 0.1f}, false}},
      {Build{"tree", std::vector<Pose>(4)}},
  };
  for (const auto& edits : history) {
    const std::string bytes = encode(mustApply(original, edits));
    ASSERT_TRUE(replayed.apply(replayed.seq() + 1, *decode(bytesOf(bytes))).ok());
  }
  const ChangeSet a = original.beginTick(1), b = replayed.beginTick(1);
  ASSERT_EQ(a.slots.size(), b.slots.size());
  for (size_t i = 0; i < a.slots.size(); ++i) {
    EXPECT_EQ(a.slots[i].slot, b.slots[i].slot);
    EXPECT_EQ(a.slots[i].instance.id, b.slots[i].instance.id);
    EXPECT_EQ(a.slots[i].instance.prefab, b.slots[i].instance.prefab);
    EXPECT_EQ(a.slots[i].instance.transform, b.slots[i].instance.transform);
  }
  EXPECT_EQ(a.environment.sun.direction, b.environment.sun.direction);
}

TEST(Codec, EveryTruncationIsRefused) {
  const std::string bytes = encode(everyKind());
  for (size_t length = 0; length < bytes.size(); ++length) {
    const Result<Batch> batch = decode(bytesOf(bytes.substr(0, length)));
    ASSERT_FALSE(batch.ok()) << length;
    EXPECT_EQ(batch.error().kind, ErrorKind::damaged);
  }
}

TEST(Codec, NamesWhatIsWrong) {
  const std::string good = encode(everyKind());
  const auto messageOf = [](const std::string& bytes) { return decode(bytesOf(bytes)).error().message; };
  EXPECT_THAT(messageOf(good + '\0'), HasSubstr("1 bytes too many"));
  EXPECT_THAT(messageOf("\x07" + good.substr(1)), HasSubstr("version 7, this server knows versions up to 2"));
  EXPECT_EQ(decode(bytesOf("\x07" + good.substr(1))).error().kind, ErrorKind::unsupported);
  EXPECT_THAT(messageOf(std::string(1, '\0') + good.substr(1)), HasSubstr("version 0"));
  EXPECT_THAT(messageOf("\x01" + kClock + std::string("\x01\x00\x00\x00\x09\x00\x00\x00\x00", 9)),
              HasSubstr("unknown kind 9 at byte 21"));
  EXPECT_THAT(messageOf(good.substr(0, good.size() - 1)), HasSubstr("truncated"));
  EXPECT_THAT(messageOf(""), HasSubstr("nothing there"));
}

TEST(Codec, CountsThatTheInputCannotHoldAreRefused) {
  const auto isRefused = [](const char* edits, size_t size) {
    return !decode(bytesOf("\x01" + kClock + std::string(edits, size))).ok();
  };
  EXPECT_FALSE(isRefused("\x01\x00\x00\x00\x02\x00\x00\x00\x00", 9));
  EXPECT_TRUE(isRefused("\xff\xff\xff\xff\x02\x00\x00\x00\x00", 9));                   // four billion edits
  EXPECT_TRUE(isRefused("\x01\x00\x00\x00\x02\xff\xff\xff\xff\x00\x00\x00\x00", 13));  // four billion ids
  EXPECT_TRUE(isRefused("\x01\x00\x00\x00\x02\x00\x00\x00\x20\x00\x00\x00\x00", 13));  // 2^29 * 8 wraps in 32 bits
}

TEST(Codec, RandomDamageNeverCrashesAndNeverPassesUnnoticed) {
  const std::string good = encode(everyKind());
  std::mt19937 random(20240607);
  const auto below = [&](size_t n) { return std::uniform_int_distribution<size_t>(0, n - 1)(random); };
  int accepted = 0;
  for (int round = 0; round < 50'000; ++round) {
    std::string bytes = good;
    for (size_t mutations = 1 + below(4); mutations > 0 && !bytes.empty(); --mutations) {
      const size_t at = below(bytes.size());
      switch (below(4)) {
        case 0:
          bytes[at] = static_cast<char>(below(256));
          break;
        case 1:
          bytes.erase(at, 1 + below(8));
          break;
        case 2:
          bytes.insert(at, 1 + below(8), static_cast<char>(below(256)));
          break;
        default:
          bytes.replace(at, std::min<size_t>(4, bytes.size() - at), 4, '\xff');
          break;
      }
    }
    const Result<Batch> batch = decode(bytesOf(bytes));
    if (!batch) continue;
    ++accepted;
    ASSERT_EQ(encode(*batch), bytes) << "round " << round;  // every byte was read and meant something
    World world(village());
    if (!world.apply(1, *batch).ok()) { EXPECT_EQ(world.instanceCount(), 4u); }
  }
  EXPECT_GT(accepted, 1000);  // damage within numbers is for apply() to judge
}

}  // namespace
}  // namespace helio::world
