// Clips, routes and the generator's own walkers.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "scene/city.h"
#include "scene/deform.h"

namespace helio::scene {
namespace {

Rig oneNode() {
  Rig rig;
  rig.nodes.resize(1);
  rig.joints = {{0, glm::mat4x3(1.0f)}};
  return rig;
}

Clip moving(Interpolation interpolation, std::vector<float> times, std::vector<float> values,
            ChannelTarget target = ChannelTarget::translation) {
  Clip clip{"clip", times.back(), {}};
  clip.channels.push_back({0, target, interpolation, std::move(times), std::move(values)});
  return clip;
}

float xAt(const Clip& clip, float time) { return nodesAt(oneNode(), clip, time)[0][3].x; }

TEST(Animation, StepsHoldAndLinesRun) {
  const std::vector<float> times{1, 2, 4}, values{1, 0, 0, 3, 0, 0, 7, 0, 0};
  const Clip step = moving(Interpolation::step, times, values), line = moving(Interpolation::linear, times, values);
  EXPECT_EQ(xAt(step, 0.0f), 1.0f);
  EXPECT_EQ(xAt(step, 1.999f), 1.0f);
  EXPECT_EQ(xAt(step, 2.0f), 3.0f);
  EXPECT_EQ(xAt(step, 9.0f), 7.0f);
  EXPECT_EQ(xAt(line, 0.5f), 1.0f);
  EXPECT_FLOAT_EQ(xAt(line, 1.5f), 2.0f);
  EXPECT_FLOAT_EQ(xAt(line, 3.0f), 5.0f);
  EXPECT_EQ(xAt(line, 4.0f), 7.0f);
}

TEST(Animation, CubicSplinesFollowTheirTangents) {
  // In-tangent, value, out-tangent: p(t) = t^2 (3 - 2 t) * 8 where tangents are 0; a parabola where they fit one.
  const Clip flat = moving(Interpolation::cubic_spline, {0, 2}, {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 8, 0, 0, 0, 0, 0});
  EXPECT_FLOAT_EQ(xAt(flat, 0.5f), 8.0f * (3.0f * 0.0625f - 2.0f * 0.015625f));
  const Clip parabola =
      moving(Interpolation::cubic_spline, {0, 2}, {0, 0, 0, 0, 0, 0, 0, 0, 0, 4, 0, 0, 4, 0, 0, 4, 0, 0});
  for (const float t : {0.3f, 1.0f, 1.7f}) EXPECT_NEAR(xAt(parabola, t), t * t, 1e-5f);
}

TEST(Animation, RotationsTakeTheShortWayAndKeepTheirLength) {
  const float h = std::sqrt(0.5f);
  const Clip turn = moving(Interpolation::linear, {0, 1}, {0, 0, 0, 1, 0, 0, -h, -h}, ChannelTarget::rotation);
  const glm::mat4x3 half = nodesAt(oneNode(), turn, 0.5f)[0];
  EXPECT_NEAR(half[0].x, h, 1e-6f);  // 45 degrees: the second key is 90 degrees, with the other sign
  EXPECT_NEAR(half[0].y, h, 1e-6f);
  EXPECT_NEAR(glm::length(half[1]), 1.0f, 1e-6f);
}

TEST(Animation, OneKeyIsAPoseAndADegenerateBoneIsFinite) {
  EXPECT_EQ(xAt(moving(Interpolation::linear, {0.5f}, {2, 0, 0}), 0.0f), 2.0f);
  EXPECT_EQ(xAt(moving(Interpolation::linear, {0.5f}, {2, 0, 0}), 7.0f), 2.0f);
  const Clip nothing = moving(Interpolation::linear, {0, 1}, {0, 0, 0, 0, 0, 0, 0, 0}, ChannelTarget::rotation);
  EXPECT_EQ(nodesAt(oneNode(), nothing, 0.5f)[0][0], glm::vec3(1, 0, 0));
  const Clip flat = moving(Interpolation::linear, {0, 1}, {1, 1, 1, -1, 0, 1}, ChannelTarget::scale);
  const glm::mat4x3 m = nodesAt(oneNode(), flat, 1.0f)[0];
  EXPECT_EQ(m[0].x, -1.0f);
  EXPECT_EQ(m[1], glm::vec3(0.0f));
}

TEST(Animation, ChildrenFollowTheirParents) {
  Rig rig;
  rig.nodes.resize(2);
  rig.nodes[1].parent = 0;
  rig.nodes[1].translation = rig.nodes[1].rest[3] = {1, 0, 0};
  const float h = std::sqrt(0.5f);
  const Clip turn = moving(Interpolation::step, {0}, {0, 0, h, h}, ChannelTarget::rotation);  // a quarter about z
  const glm::vec3 end = nodesAt(rig, turn, 0.0f)[1][3];
  EXPECT_NEAR(end.x, 0.0f, 1e-6f);
  EXPECT_NEAR(end.y, 1.0f, 1e-6f);
}

TEST(Animation, ClipsBeginAnewWhateverTheTime) {
  EXPECT_EQ(clipTime(5.0, 0.0f), 0.0);
  EXPECT_DOUBLE_EQ(clipTime(7.25, 2.0f), 1.25);
  EXPECT_DOUBLE_EQ(clipTime(-0.5, 2.0f), 1.5);
  EXPECT_NEAR(clipTime(1e9 + 0.5, 1.0f), 0.5, 1e-6);
}

TEST(Animation, ARouteIsClosedUprightAndAhead) {
  const Route square({{0, 1, 0}, {20, 1, 0}, {20, 2, 20}, {0, 2, 20}});
  const glm::mat4x3 start = square.at(10.0);
  EXPECT_NEAR(glm::distance(start[3], glm::vec3(10, 1, 0)), 0.0f, 1e-4f);
  EXPECT_NEAR(start[2].x, 1.0f, 1e-5f);  // it looks along +x
  EXPECT_EQ(start[1], glm::vec3(0, 1, 0));
  EXPECT_NEAR(glm::determinant(glm::mat3(start)), 1.0f, 1e-5f);
  const auto length = static_cast<double>(square.length());
  EXPECT_NEAR(glm::distance(square.at(10.0)[3], square.at(10.0 + 1000.0 * length)[3]), 0.0f, 0.05f);
  for (double s = 0.0; s < length; s += 0.05)
    EXPECT_LT(glm::distance(square.at(s)[3], square.at(s + 0.05)[3]), 0.06f) << s;
  EXPECT_EQ(Route().at(3.0), glm::mat4x3(1.0f));
  EXPECT_EQ(Route({{1, 2, 3}}).at(3.0)[3], glm::vec3(1, 2, 3));
}

TEST(Animation, TheGroundIsTwoTrianglesASquare) {
  const HeightGrid grid{{10, 20}, 2.0f, 2, {0, 1, 2, 7}};
  EXPECT_FLOAT_EQ(grid.height({10, 20}), 0.0f);
  EXPECT_FLOAT_EQ(grid.height({12, 22}), 7.0f);
  EXPECT_FLOAT_EQ(grid.height({11, 21}), 3.5f);         // on the shared diagonal
  EXPECT_FLOAT_EQ(grid.height({11.5f, 20.5f}), 2.25f);  // 0 + 0.75 * 1 + 0.25 * 6
  EXPECT_FLOAT_EQ(grid.height({-100, 400}), 2.0f);      // the border goes on
}

/// A city with some of everything that moves, made once.
const Scene& city() {
  static const ScenePtr scene = *generateCity({1, 1'000, 400});
  return *scene;
}

std::vector<uint32_t> walkers() {
  std::vector<uint32_t> prefabs;
  for (uint32_t p = 0; p < city().prefabs.size(); ++p)
    if (city().prefabs[p].category == "walker") prefabs.push_back(p);
  return prefabs;
}

TEST(Walkers, HaveEightLooksAndMoreWithSkeletonsAndGaitsOfTheirOwn) {
  EXPECT_GE(walkers().size(), 8u);
  std::vector<float> strides;
  for (const uint32_t p : walkers()) {
    const Prefab& prefab = city().prefabs[p];
    ASSERT_NE(prefab.rig, kNone);
    const Rig& rig = city().rigs[prefab.rig];
    EXPECT_EQ(rig.joints.size(), 13u);
    strides.push_back(rig.clips[prefab.travel_clip].duration * prefab.travel_speed);
    EXPECT_GT(city().meshes[prefab.mesh].indices.size() / 3, 300u);
    EXPECT_LT(city().meshes[prefab.mesh].indices.size() / 3, 1'200u);
  }
  std::sort(strides.begin(), strides.end());
  EXPECT_GT(strides.back() - strides.front(), 0.2f);
}

TEST(Walkers, WalkOnTheGroundAndTheirFeetDoNotSlide) {
  for (const uint32_t p : walkers()) {
    const Prefab& prefab = city().prefabs[p];
    const Mesh& mesh = city().meshes[prefab.mesh];
    const Rig& rig = city().rigs[prefab.rig];
    const Clip& gait = rig.clips[prefab.travel_clip];
    constexpr int kTimes = 40;
    const float step = gait.duration / kTimes;
    float least_slip_at_worst = 0.0f;
    for (int i = 0; i < kTimes; ++i) {
      const float time = step * static_cast<float>(i);
      const std::vector<glm::vec3> now = deformedPositions(mesh, rig, gait, time);
      const std::vector<glm::vec3> next = deformedPositions(mesh, rig, gait, std::fmod(time + step, gait.duration));
      float lowest = 1e9f, least_slip = 1e9f;
      for (size_t v = 0; v < now.size(); ++v) {
        ASSERT_TRUE(std::isfinite(now[v].x + now[v].y + now[v].z)) << prefab.name;
        lowest = std::min(lowest, now[v].y);
        if (now[v].y > 0.03f) continue;
        // In the world, where the body has gone ahead meanwhile.
        least_slip = std::min(least_slip, std::abs(next[v].z - now[v].z + prefab.travel_speed * step));
      }
      EXPECT_GT(lowest, -0.035f) << prefab.name << " at " << time;
      EXPECT_LT(lowest, 0.03f) << prefab.name << " at " << time;
      least_slip_at_worst = std::max(least_slip_at_worst, least_slip / (prefab.travel_speed * step));
    }
    EXPECT_LT(least_slip_at_worst, 0.3f) << prefab.name;  // of the body's speed
    // Bounds hold every pose.
    for (const float time : {0.1f, 0.33f, 0.77f})
      for (const glm::vec3& v : deformedPositions(mesh, rig, gait, time * gait.duration)) {
        EXPECT_TRUE(glm::all(glm::greaterThanEqual(v, mesh.bounds.min)) &&
                    glm::all(glm::lessThanEqual(v, mesh.bounds.max)));
      }
  }
}

TEST(MovingCity, HasTheUnitsAskedForOnTheGroundAndOnTheirWays) {
  const Scene& scene = city();
  EXPECT_EQ(scene.placements.size(), 1'400u);
  size_t travelling = 0, mills = 0, fitted = 0, vehicles = 0;
  for (const Placement& placement : scene.placements) {
    const Prefab& prefab = scene.prefabs[placement.prefab];
    mills += prefab.name == "windmill_turning";
    fitted += scene.meshes[prefab.mesh].fit_height > 0.0f;
    if (placement.route == kNone) continue;
    ++travelling;
    vehicles += prefab.category == "vehicle";
    ASSERT_LT(placement.route, scene.routes.size());
    const Route& route = scene.routes[placement.route];
    EXPECT_EQ(route.at(static_cast<double>(placement.route_start)), placement.transform);
    for (const double time : {0.0, 3.7, 1000.0}) {
      const glm::vec3 p =
          route.at(static_cast<double>(placement.route_start) + static_cast<double>(placement.route_speed) * time)[3];
      const float over = p.y - scene.ground.height({p.x, p.z});
      EXPECT_GT(over, -0.1f);
      EXPECT_LT(over, 0.35f);  // a kerb's height
    }
  }
  EXPECT_EQ(travelling + mills + fitted, 400u);
  EXPECT_GT(vehicles, 5u);
  EXPECT_GT(mills, 0u);
  EXPECT_GT(fitted, 0u);
}

TEST(MovingCity, LeavesTheStandingCityAsItIs) {
  const ScenePtr still = *generateCity({1, 1'000, 0});
  EXPECT_EQ(still->placements.size(), 1'000u);
  EXPECT_EQ(still->prefabs.size(), city().prefabs.size());  // all can be built in either
  EXPECT_TRUE(still->routes.empty());
  const Result<ScenePtr> refused = generateCity({1, 1'000, 10'001});
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().field, "animated");
}

}  // namespace
}  // namespace helio::scene
