// What users may send: every rule, its error's kind, field, value and limit, and that a refused batch changes nothing.
#include <cmath>
#include <limits>

#include "scene/city.h"
#include "village.h"

namespace helio::world {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::StartsWith;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();

Limits smallLimits() {
  Limits limits;
  limits.max_instances = 8;
  limits.max_edits_per_batch = 5;
  limits.max_poses_per_batch = 6;
  limits.max_regions_per_batch = 2;
  limits.max_coordinate = 1000.0f;
  return limits;
}

Pose badPose(glm::vec3 position, glm::quat rotation = {1, 0, 0, 0}, float scale = 1.0f) {
  return {position, rotation, scale};
}

Edit sun(glm::vec3 direction, glm::vec3 irradiance = {1, 1, 1}, float diameter = 0.01f) {
  return SetSun{{direction, irradiance, diameter}, false};
}

struct Refusal {
  std::string name;
  std::vector<Edit> edits;
  ErrorKind kind;
  std::string field;
  std::string value;
  std::string limit;
};

std::vector<Refusal> refusals() {
  const Edit good = Build{"house", {poseAt(0, 0)}};
  const auto inv = ErrorKind::invalid;
  std::vector<Refusal> table = {
      {"EmptyBatch", {}, inv, "edits", "0", ""},
      {"TooManyEdits", std::vector<Edit>(6, good), ErrorKind::limit, "edits", "6", "5"},
      {"UnknownPrefab",
       {Build{"castle", {poseAt(0, 0)}}},
       ErrorKind::not_found,
       "edits[0].build.prefab",
       "\"castle\"",
       ""},
      {"UnbuildablePrefab", {good, Build{"terrain", {poseAt(0, 0)}}}, inv, "edits[1].build.prefab", "terrain", ""},
      {"NoPoses", {Build{"house", {}}}, inv, "edits[0].build.poses", "0", ""},
      {"TooManyPoses",
       {Build{"house", std::vector<Pose>(4)}, Destroy{{2, 3, 4}}, Build{"house", std::vector<Pose>(3)}},
       ErrorKind::limit,
       "edits[2].build.poses",
       "7",
       "6"},
      {"TooManyInstances", {Build{"house", std::vector<Pose>(5)}}, ErrorKind::limit, "edits[0].build.poses", "9", "8"},
      {"PositionNan",
       {Build{"house", {poseAt(0, 0), badPose({0, kNan, 0})}}},
       inv,
       "edits[0].build.poses[1].position",
       "(0, nan, 0)",
       ""},
      {"PositionFar",
       {Build{"house", {badPose({0, 0, -1001})}}},
       inv,
       "edits[0].build.poses[0].position",
       "(0, 0, -1001)",
       "1000"},
      {"ScaleZero",
       {good, Build{"house", {poseAt(0, 0), poseAt(0, 0, 0.0f)}}},
       inv,
       "edits[1].build.poses[1].scale",
       "0",
       "1000"},
      {"ScaleNegative", {Build{"house", {poseAt(0, 0, -1.0f)}}}, inv, "edits[0].build.poses[0].scale", "-1", "1000"},
      {"ScaleHuge", {Build{"house", {poseAt(0, 0, 1000.5f)}}}, inv, "edits[0].build.poses[0].scale", "1000.5", "1000"},
      {"ScaleNan", {Build{"house", {poseAt(0, 0, kNan)}}}, inv, "edits[0].build.poses[0].scale", "nan", "1000"},
      {"RotationZero",
       {Build{"house", {badPose({}, {0, 0, 0, 0})}}},
       inv,
       "edits[0].build.poses[0].rotation",
       "(0, 0, 0, 0)",
       ""},
      {"RotationInfinite",
       {Build{"house", {badPose({}, {1, kInf, 0, 0})}}},
       inv,
       "edits[0].build.poses[0].rotation",
       "(inf, 0, 0, 1)",
       ""},
      {"DestroyNothing", {Destroy{{}}}, inv, "edits[0].destroy.ids", "0", ""},
      {"DestroyUnknown",
       {good, good, good, Destroy{{2, 99}}},
       ErrorKind::not_found,
       "edits[3].destroy.ids[1]",
       "99",
       ""},
      {"DestroyTerrain", {Destroy{{2, 1}}}, inv, "edits[0].destroy.ids[1]", "1", ""},
      {"DestroyTwiceInOneEdit", {Destroy{{2, 3, 2}}}, ErrorKind::not_found, "edits[0].destroy.ids[2]", "2", ""},
      {"DestroyTwiceInOneBatch",
       {Destroy{{2}}, Destroy{{3, 2}}},
       ErrorKind::not_found,
       "edits[1].destroy.ids[1]",
       "2",
       ""},
      {"DestroyBuiltInThisBatch", {good, Destroy{{5}}}, ErrorKind::not_found, "edits[1].destroy.ids[0]", "5", ""},
      {"DestroyAfterRegion",
       {DestroyRegion{{11, 3}, 1}, Destroy{{2}}},
       ErrorKind::not_found,
       "edits[1].destroy.ids[0]",
       "2",
       ""},
      {"RegionNan", {DestroyRegion{{0, kNan}, 1}}, inv, "edits[0].destroy_region.centre", "(0, nan)", ""},
      {"RegionWithoutRadius", {DestroyRegion{{0, 0}, 0}}, inv, "edits[0].destroy_region.radius", "0", ""},
      {"RegionInfinite", {DestroyRegion{{0, 0}, kInf}}, inv, "edits[0].destroy_region.radius", "inf", ""},
      {"TooManyRegions", std::vector<Edit>(3, DestroyRegion{{0, 0}, 1}), ErrorKind::limit, "edits[2].destroy_region",
       "3", "2"},
      {"MoveUnknown", {Move{77, poseAt(0, 0)}}, ErrorKind::not_found, "edits[0].move.id", "77", ""},
      {"MoveTerrain", {Move{1, poseAt(0, 0)}}, inv, "edits[0].move.id", "1", ""},
      {"MoveDestroyed", {Destroy{{3}}, Move{3, poseAt(0, 0)}}, ErrorKind::not_found, "edits[1].move.id", "3", ""},
      {"MoveFar", {Move{2, poseAt(1e5f, 0)}}, inv, "edits[0].move.pose.position", "(100000, 0, 0)", "1000"},
      {"SunWithoutDirection", {sun({0, 0, 0})}, inv, "edits[0].set_sun.direction", "(0, 0, 0)", ""},
      {"SunDirectionNan", {sun({0, kNan, 0})}, inv, "edits[0].set_sun.direction", "(0, nan, 0)", ""},
      {"SunNegative", {good, sun({0, -1, 0}, {1, -2, 1})}, inv, "edits[1].set_sun.irradiance", "(1, -2, 1)", ""},
      {"SunInfinite", {sun({0, -1, 0}, {1, 1, kInf})}, inv, "edits[0].set_sun.irradiance", "(1, 1, inf)", ""},
      {"SunIsAPoint", {sun({0, -1, 0}, {1, 1, 1}, 0)}, inv, "edits[0].set_sun.angular_diameter", "0", "0.5"},
      {"SunTooWide", {sun({0, -1, 0}, {1, 1, 1}, 0.75f)}, inv, "edits[0].set_sun.angular_diameter", "0.75", "0.5"},
  };
  return table;
}

class Refused : public ::testing::TestWithParam<Refusal> {};

TEST_P(Refused, NamesWhatIsWrongAndChangesNothing) {
  World world(village(), smallLimits());
  world.beginTick(0);

  const Result<Batch> batch = world.resolve(GetParam().edits);
  ASSERT_FALSE(batch.ok());
  EXPECT_EQ(batch.error().kind, GetParam().kind) << batch.error().message;
  EXPECT_EQ(batch.error().field, GetParam().field);
  EXPECT_EQ(batch.error().value, GetParam().value);
  EXPECT_EQ(batch.error().limit, GetParam().limit);
  EXPECT_THAT(batch.error().message, StartsWith(GetParam().field));
  EXPECT_EQ(batch.error().message.find('\n'), std::string::npos);

  EXPECT_EQ(world.seq(), 0u);
  EXPECT_THAT(idsIn(world), ElementsAre(1, 2, 3, 4));
  const ChangeSet changes = world.beginTick(0);
  EXPECT_TRUE(changes.slots.empty());
  EXPECT_FALSE(changes.environment_changed);
}

std::ostream& operator<<(std::ostream& out, const Refusal& refusal) { return out << refusal.name; }

INSTANTIATE_TEST_SUITE_P(Edits, Refused, ::testing::ValuesIn(refusals()),
                         [](const auto& info) { return info.param.name; });

TEST(Resolve, AssignsIdsInOrderAndChangesNothing) {
  World world(village());
  const std::vector<Edit> edits = {Build{"house", {poseAt(1, 1), poseAt(2, 2)}}, Build{"tree", {poseAt(3, 3)}}};
  for (int repeat = 0; repeat < 2; ++repeat) {  // unapplied, the same ids come again
    const Result<Batch> batch = world.resolve(edits);
    ASSERT_TRUE(batch.ok());
    EXPECT_EQ(std::get<ResolvedBuild>(batch->edits[0]).first_id, 5u);
    EXPECT_EQ(std::get<ResolvedBuild>(batch->edits[0]).prefab, kHouse);
    EXPECT_EQ(std::get<ResolvedBuild>(batch->edits[1]).first_id, 7u);
    EXPECT_EQ(std::get<ResolvedBuild>(batch->edits[1]).prefab, kTree);
  }
  EXPECT_EQ(world.instanceCount(), 4u);
}

TEST(Resolve, AcceptsTheLimitsThemselves) {
  World world(village(), smallLimits());
  Pose pose = poseAt(1000, -1000, 1000.0f);
  EXPECT_TRUE(world.resolve(std::vector<Edit>{Build{"house", std::vector<Pose>(4, pose)}}).ok());
  EXPECT_TRUE(world.resolve(std::vector<Edit>{sun({0, -1, 0}, {0, 0, 0}, 0.5f)}).ok());
}

TEST(Resolve, DestroyingMakesRoomForBuildingInTheSameBatch) {
  World world(village(), smallLimits());
  const std::vector<Edit> edits = {Destroy{{2, 3, 4}}, Build{"house", std::vector<Pose>(6)}};
  EXPECT_TRUE(world.resolve(edits).ok());
  const std::vector<Edit> one_more = {DestroyRegion{{0, 0}, 500}, Build{"house", std::vector<Pose>(6)},
                                      Build{"house", {{}}}};
  EXPECT_EQ(world.resolve(one_more).error().kind, ErrorKind::limit);
}

TEST(Resolve, NormalisesRotations) {
  World world(village());
  Pose pose;
  pose.rotation = glm::quat(3e30f, 0, 4e30f, 0);  // its squared length overflows a float
  const Result<Batch> batch = world.resolve(std::vector<Edit>{Build{"house", {pose}}});
  ASSERT_TRUE(batch.ok());
  const glm::quat q = std::get<ResolvedBuild>(batch->edits[0]).poses[0].rotation;
  EXPECT_FLOAT_EQ(q.w, 0.6f);
  EXPECT_FLOAT_EQ(q.y, 0.8f);
}

TEST(Resolve, RegionsTakeWhatUsersMayBuildByTheCentreOfItsBounds) {
  World world(village());
  const auto destroyedBy = [&](DestroyRegion region) {
    return std::get<ResolvedDestroy>(world.resolve(std::vector<Edit>{region})->edits[0]).ids;
  };
  EXPECT_THAT(destroyedBy({{0, 0}, 1000}), ElementsAre(2, 3, 4));  // the terrain stays
  EXPECT_THAT(destroyedBy({{11, 3}, 0.5f}), ElementsAre(2));       // the house's centre
  EXPECT_THAT(destroyedBy({{10, 0}, 0.5f}), ElementsAre());        // its origin
  EXPECT_THAT(destroyedBy({{11, 0}, 3.0f}), ElementsAre(2));       // exactly on the rim
  EXPECT_THAT(destroyedBy({{11, 0}, 2.99f}), ElementsAre());
}

TEST(Resolve, RegionsSeeWhatTheBatchDidBefore) {
  World world(village());
  const std::vector<Edit> edits = {
      Build{"tree", {poseAt(300, 300), poseAt(301, 300)}},  // ids 5 and 6
      Move{2, poseAt(299, 297)},                            // the house's centre comes to (300, 300)
      Move{3, poseAt(300, 300)},
      Move{3, poseAt(600, 600)},  // and goes again
      Destroy{{4}},
      DestroyRegion{{300, 300}, 1.0f},
      DestroyRegion{{300, 300}, 1.0f},
  };
  const Result<Batch> batch = world.resolve(edits);
  ASSERT_TRUE(batch.ok()) << batch.error().message;
  EXPECT_THAT(std::get<ResolvedDestroy>(batch->edits[5]).ids, ElementsAre(2, 5, 6));
  EXPECT_THAT(std::get<ResolvedDestroy>(batch->edits[6]).ids, ElementsAre());
  ASSERT_TRUE(world.apply(1, *batch).ok());
  EXPECT_THAT(idsIn(world), ElementsAre(1, 3));
}

TEST(Resolve, TheSunBringsItsSky) {
  World world(village());
  const float elevation = 0.3f, azimuth = 0.8f;
  const glm::vec3 towards{std::cos(elevation) * std::sin(azimuth), std::sin(elevation),
                          std::cos(elevation) * std::cos(azimuth)};
  const scene::Sun sun{-2.0f * towards, {5, 4, 3}, 0.02f};
  const Result<Batch> batch = world.resolve(std::vector<Edit>{SetSun{sun, true}});
  ASSERT_TRUE(batch.ok());
  const scene::Environment& environment = std::get<ResolvedEnvironment>(batch->edits[0]).environment;
  const scene::Sky expected = scene::daylight(elevation, azimuth).sky;
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(environment.sky.zenith[i], expected.zenith[i], 1e-5f * (1 + expected.zenith[i]));
    EXPECT_NEAR(environment.sky.ground[i], expected.ground[i], 1e-5f * (1 + expected.ground[i]));
    EXPECT_NEAR(environment.sun.direction[i], -towards[i], 1e-6f);
  }
  EXPECT_NE(environment.sky.zenith, village()->environment.sky.zenith);
  EXPECT_EQ(environment.sun.irradiance, sun.irradiance);  // as the user gave it
  EXPECT_EQ(environment.sun.angular_diameter, 0.02f);
}

TEST(Resolve, WithoutDaylightTheSkyStaysAsTheBatchLeftIt) {
  World world(village());
  const scene::Sun sun{{1, -1, 0}, {5, 4, 3}, 0.02f};
  const scene::Sky before = village()->environment.sky;
  EXPECT_EQ(std::get<ResolvedEnvironment>(world.resolve(std::vector<Edit>{SetSun{sun, false}})->edits[0])
                .environment.sky.zenith,
            before.zenith);
  const Result<Batch> both =
      world.resolve(std::vector<Edit>{SetSun{sun, true}, SetSun{{{0, -1, 0}, {1, 1, 1}, 0.01f}, false}});
  EXPECT_EQ(std::get<ResolvedEnvironment>(both->edits[1]).environment.sky.zenith,
            std::get<ResolvedEnvironment>(both->edits[0]).environment.sky.zenith);
}

}  // namespace
}  // namespace helio::world
