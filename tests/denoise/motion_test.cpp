// Motion vectors point to where things were, for all that can move, in rasterised and traced pictures alike: against
// rays and poses of the CPU.
#include <array>
#include <cmath>
#include <limits>

#include "render/camera_frame.h"
#include "scene/city.h"
#include "scene/deform.h"
#include "support/scenes.h"
#include "support/stage.h"

namespace helio::test {
namespace {

using render::Inspect;
using render::Primary;
using scene::kNone;

constexpr uint32_t kWidth = 160, kHeight = 90;

render::ViewSettings inspecting(Primary primary, Inspect inspect) {
  render::ViewSettings settings;
  settings.width = kWidth;
  settings.height = kHeight;
  settings.primary = primary;
  settings.bounces = 0;
  settings.accumulate = false;
  settings.keep_radiance = true;
  settings.levels_of_detail = false;  // the CPU knows the finest
  settings.inspect = inspect;
  return settings;
}

/// A walker with a gait on the spot, a car that drives past, a mill whose sails turn, and a floor.
scene::ScenePtr street() {
  scene::Scene scene = **scene::generateCity({1, 1'000, 100});
  scene.placements.clear();
  scene.textures.clear();
  for (scene::Material& material : scene.materials) {
    material = {};
    material.base_color = {0.6f, 0.6f, 0.6f, 1.0f};
  }
  const uint32_t walker = scene.findPrefab("walker_smith"), car = scene.findPrefab("vehicle_car_a"),
                 mill = scene.findPrefab("windmill_turning");
  scene.prefabs[walker].clip = scene.prefabs[walker].travel_clip;
  for (const uint32_t p : {walker, car, mill}) scene.prefabs[p].out_of_step = false;
  scene.routes = {scene::Route({{-40.0f, 0, -6.0f}, {40.0f, 0, -6.0f}, {40.0f, 0, -60.0f}, {-40.0f, 0, -60.0f}})};
  scene::Placement driving{car, glm::mat4x3(1.0f)};
  driving.route = 0;
  driving.route_start = 37.0f;
  driving.route_speed = 9.0f;
  driving.transform = scene.routes[0].at(37.0);
  scene::Mesh floor = quad(60.0f);
  floor.submeshes = {{0, static_cast<uint32_t>(floor.indices.size()), 0}};
  floor.finish();
  scene.meshes.push_back(floor);
  scene::Prefab ground = scene.prefabs[mill];
  ground.name = "test_floor";
  ground.mesh = static_cast<uint32_t>(scene.meshes.size() - 1);
  ground.rig = ground.node = kNone;
  scene.prefabs.push_back(ground);
  const auto floor_prefab = static_cast<uint32_t>(scene.prefabs.size() - 1);
  scene.placements = {
      {walker, at({-0.8f, 0, 0})}, driving, {mill, at({6.0f, -6.0f, -16.0f})}, {floor_prefab, at({0, -0.01f, 0})}};
  scene.ground = {};
  return std::make_shared<scene::Scene>(std::move(scene));
}

enum Kind { kSkinned, kDriving, kTurning, kStanding, kKinds };

/// All triangles of the scene at a time, corner by corner; `kinds`: of each placement.
struct Shape {
  std::vector<glm::vec3> corners;
  std::vector<Kind> kinds;  // a triangle
};

Shape shapeAt(const scene::Scene& scene, double time) {
  Shape shape;
  for (size_t p = 0; p < scene.placements.size(); ++p) {
    const scene::Placement& placed = scene.placements[p];
    const scene::Prefab& prefab = scene.prefabs[placed.prefab];
    const scene::Mesh& mesh = scene.meshes[prefab.mesh];
    glm::mat4x3 transform = placed.transform;
    std::vector<glm::vec3> positions = mesh.positions;
    const bool drives = placed.route != kNone;
    const double way =
        drives ? static_cast<double>(placed.route_start) + static_cast<double>(placed.route_speed) * time : 0.0;
    if (drives) transform = scene.routes[placed.route].at(way);
    if (prefab.rig != kNone) {
      const scene::Rig& rig = scene.rigs[prefab.rig];
      const scene::Clip& clip = rig.clips[drives ? prefab.travel_clip : prefab.clip];
      const auto at = static_cast<float>(
          scene::clipTime(drives ? way / static_cast<double>(prefab.travel_speed) : time, clip.duration));
      if (!mesh.skin.empty() || !mesh.morph_targets.empty()) positions = scene::deformedPositions(mesh, rig, clip, at);
      else if (prefab.node != kNone)
        transform = scene::concatenate(transform, scene::nodesAt(rig, clip, at)[prefab.node]);
    }
    for (const uint32_t index : mesh.indices) shape.corners.push_back(transform * glm::vec4(positions[index], 1.0f));
    shape.kinds.resize(shape.corners.size() / 3, static_cast<Kind>(p));
  }
  return shape;
}

struct CpuHit {
  size_t triangle = 0;
  float distance = std::numeric_limits<float>::infinity();
  glm::vec3 weights{0.0f};
  glm::vec3 in(const Shape& shape) const {
    const glm::vec3* c = &shape.corners[3 * triangle];
    return c[0] * weights.x + c[1] * weights.y + c[2] * weights.z;
  }
};

/// [Moeller and Trumbore 1997]
CpuHit cast(const Shape& shape, const glm::vec3& origin, const glm::vec3& direction) {
  CpuHit nearest;
  for (size_t t = 0; t < shape.kinds.size(); ++t) {
    const glm::vec3* c = &shape.corners[3 * t];
    const glm::vec3 e1 = c[1] - c[0], e2 = c[2] - c[0], q = glm::cross(direction, e2);
    const float det = glm::dot(e1, q);
    if (std::abs(det) < 1e-12f) continue;
    const glm::vec3 s = origin - c[0], r = glm::cross(s, e1);
    const float u = glm::dot(s, q) / det, v = glm::dot(direction, r) / det, d = glm::dot(e2, r) / det;
    if (u < 0.0f || v < 0.0f || u + v > 1.0f || d <= 0.0f || d >= nearest.distance) continue;
    nearest = {t, d, {1.0f - u - v, u, v}};
  }
  return nearest;
}

glm::vec3 rayThrough(const scene::Camera& camera, uint32_t x, uint32_t y) {
  const render::CameraFrame f = render::cameraFrame(camera);
  const float nx = 2.0f * (static_cast<float>(x) + 0.5f) / kWidth - 1.0f,
              ny = 2.0f * (static_cast<float>(y) + 0.5f) / kHeight - 1.0f;
  const float aspect = static_cast<float>(kWidth) / kHeight;
  return glm::normalize(f.forward + f.tangent * (nx * aspect * f.right - ny * f.up));
}

/// Pixels, and metres of depth.
glm::vec3 projected(const scene::Camera& camera, const glm::vec3& point) {
  const render::CameraFrame f = render::cameraFrame(camera);
  const glm::vec3 relative = point - camera.position;
  const float depth = glm::dot(relative, f.forward), aspect = static_cast<float>(kWidth) / kHeight;
  return {(0.5f + 0.5f * glm::dot(relative, f.right) / (depth * f.tangent * aspect)) * kWidth,
          (0.5f - 0.5f * glm::dot(relative, f.up) / (depth * f.tangent)) * kHeight, depth};
}

const scene::Camera kBefore = lookAt({0.5f, 1.8f, 5.5f}, {0.4f, 1.2f, 0}, 0.9f);
const scene::Camera kNow = lookAt({0.62f, 1.85f, 5.4f}, {0.45f, 1.15f, 0}, 0.9f);
constexpr double kStep = 1.0 / 30.0;

/// Shows what `inspect` asks for in the second of two ticks, between which camera and world went on.
render::Frame second(const scene::ScenePtr& scene, Primary primary, Inspect inspect) {
  Stage stage(scene);
  stage.setStep(kStep);
  (void)stage.tick(kBefore, inspecting(primary, inspect));
  render::Frame frame = stage.tick(kNow, inspecting(primary, inspect));
  showPicture(frame, "inspect_" + std::to_string(static_cast<int>(inspect)));
  return frame;
}

struct MotionTest : testing::TestWithParam<Primary> {};

TEST_P(MotionTest, PointsToWhereTheSurfaceWas) {
  const scene::ScenePtr scene = street();
  const render::Frame motion = second(scene, GetParam(), Inspect::motion),
                      position = second(scene, GetParam(), Inspect::position),
                      before = second(scene, GetParam(), Inspect::before);
  const double time = motion.stats.time;
  const Shape now = shapeAt(*scene, time), then = shapeAt(*scene, time - kStep);
  std::array<size_t, kKinds> seen{}, wrong{}, moved{};
  for (uint32_t y = 1; y < kHeight; y += 2)
    for (uint32_t x = 0; x < kWidth; ++x) {
      const CpuHit hit = cast(now, kNow.position, rayThrough(kNow, x, y));
      if (std::isinf(hit.distance)) continue;
      const Kind kind = now.kinds[hit.triangle];
      // At an edge, the GPU may see the other side of it.
      if (glm::distance(texel(position, x, y), hit.in(now)) > 0.002f * hit.distance) continue;
      const glm::vec3 expected = projected(kBefore, hit.in(then)) - projected(kNow, hit.in(now));
      const glm::vec3 found = texel(motion, x, y);
      ++seen[kind];
      moved[kind] += glm::distance(hit.in(then), hit.in(now)) > 0.005f;
      wrong[kind] += !(glm::distance(texel(before, x, y), hit.in(then)) < 0.003f) ||
                     !(std::abs(found.x - expected.x) < 0.05f && std::abs(found.y - expected.y) < 0.05f &&
                       std::abs(found.z - expected.z) < 0.01f);
    }
  for (const Kind kind : {kSkinned, kDriving, kTurning, kStanding}) {
    EXPECT_GT(seen[kind], 40u) << "kind " << kind;
    EXPECT_LE(wrong[kind], seen[kind] / 200) << "kind " << kind << " of " << seen[kind];
  }
  EXPECT_GT(moved[kSkinned], 20u);
  EXPECT_EQ(moved[kDriving], seen[kDriving]);
  EXPECT_GT(moved[kTurning], 20u);
  EXPECT_EQ(moved[kStanding], 0u);
}

TEST_P(MotionTest, IsNoneWhileCameraAndWorldStandStill) {
  const scene::ScenePtr scene = street();
  Stage stage(scene);
  stage.setStep(kStep);
  (void)stage.tick(kNow, inspecting(GetParam(), Inspect::motion));
  stage.setStep(0.0);  // what moved in the tick before has stopped
  const render::Frame motion = stage.tick(kNow, inspecting(GetParam(), Inspect::motion));
  for (const float value : motion.radiance) ASSERT_LT(std::abs(value), 1e-3f);
}

TEST_P(MotionTest, OfTheSkyFollowsTheCamerasTurnAlone) {
  SceneBuilder builder;
  builder.place(builder.prefab("speck", quad(0.01f), builder.material(lambert(glm::vec3(0.5f)))), at({0, -50.0f, 0}));
  const scene::ScenePtr scene = builder.build();
  scene::Camera before = lookAt({0, 0, 0}, {0, 0.2f, -1.0f}, 0.9f), now = before;
  now.position = {3.0f, 1.0f, -2.0f};
  Stage stage(scene);
  (void)stage.tick(before, inspecting(GetParam(), Inspect::motion));
  const render::Frame moved = stage.tick(now, inspecting(GetParam(), Inspect::motion));
  for (const float value : moved.radiance) ASSERT_LT(std::abs(value), 1e-3f);
  before = now;
  now.forward = glm::normalize(glm::vec3(0.05f, 0.2f, -1.0f));
  const glm::vec3 turned = texel(stage.tick(now, inspecting(GetParam(), Inspect::motion)), kWidth / 2, kHeight / 2);
  const glm::vec3 far = now.position + 1e5f * rayThrough(now, kWidth / 2, kHeight / 2);
  const glm::vec3 expected = projected(before, far) - projected(now, far);
  EXPECT_NEAR(turned.x, expected.x, 0.02f);
  EXPECT_NEAR(turned.y, expected.y, 0.02f);
  EXPECT_GT(std::abs(turned.x), 2.0f);
}

TEST_P(MotionTest, IsKeptWhenUnitsComeAndGo) {
  const scene::ScenePtr scene = street();
  Stage stage(scene);
  stage.setStep(kStep);
  const render::ViewSettings settings = inspecting(GetParam(), Inspect::before);
  (void)stage.tick(kBefore, settings);
  stage.edit({world::Destroy{{1}}});  // the walker
  const render::Frame first = stage.tick(kNow, settings);
  render::Frame shown;
  render::ViewSettings positions = settings;
  positions.inspect = Inspect::position;
  Stage other(scene);
  other.setStep(kStep);
  (void)other.tick(kBefore, positions);
  other.edit({world::Destroy{{1}}});
  const render::Frame now = other.tick(kNow, positions);
  const Shape shape = shapeAt(*scene, first.stats.time), then = shapeAt(*scene, first.stats.time - kStep);
  size_t driving = 0;
  for (uint32_t y = 0; y < kHeight; y += 3)
    for (uint32_t x = 0; x < kWidth; x += 3) {
      const CpuHit hit = cast(shape, kNow.position, rayThrough(kNow, x, y));
      if (std::isinf(hit.distance) || glm::distance(texel(now, x, y), hit.in(shape)) > 0.002f * hit.distance) continue;
      EXPECT_NE(shape.kinds[hit.triangle], kSkinned);
      if (shape.kinds[hit.triangle] != kDriving) continue;
      ++driving;
      EXPECT_LT(glm::distance(texel(first, x, y), hit.in(then)), 0.003f);
    }
  EXPECT_GT(driving, 10u);
}

TEST(Motion, CostsNothingUnlessAskedFor) {
  Stage stage(street());
  render::ViewSettings settings = inspecting(Primary::traced, Inspect::nothing);
  const render::Frame without = stage.tick(kNow, settings);
  EXPECT_FALSE(recorded(without, "motion"));
  EXPECT_EQ(without.stats.history_bytes, 0u);
  settings.inspect = Inspect::motion;
  const render::Frame with = stage.tick(kNow, settings);
  EXPECT_TRUE(recorded(with, "motion"));
  EXPECT_GT(with.stats.history_bytes, 0u);
  EXPECT_GT(with.stats.memory.path_tracing, without.stats.memory.path_tracing);
  settings.inspect = Inspect::nothing;
  const render::Frame again = stage.tick(kNow, settings);
  EXPECT_FALSE(recorded(again, "motion"));
  EXPECT_EQ(again.stats.memory.path_tracing, without.stats.memory.path_tracing);
}

INSTANTIATE_TEST_SUITE_P(Motion, MotionTest, testing::Values(Primary::raster, Primary::traced),
                         [](const auto& info) { return info.param == Primary::raster ? "raster" : "traced"; });

}  // namespace
}  // namespace helio::test
