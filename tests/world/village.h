// A village of four instances that every test of this folder starts from.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "world/world.h"

namespace helio::world {

enum VillagePrefab : uint32_t { kTerrain = 0, kHouse = 1, kTree = 2 };

inline scene::Mesh boxMesh(const glm::vec3& low, const glm::vec3& high) {
  scene::Mesh mesh;
  mesh.bounds.grow(low);
  mesh.bounds.grow(high);
  return mesh;
}

inline glm::mat4x3 placedAt(float x, float y, float z) {
  glm::mat4x3 m(1.0f);
  m[3] = {x, y, z};
  return m;
}

/// Terrain around the origin (id 1), houses at x = 10 and x = 40 (ids 2 and 3), a tree at z = 100 (id 4). The bounds'
/// centre of a house is at (1, 2, 3) from where it is placed.
inline scene::ScenePtr village() {
  auto scene = std::make_shared<scene::Scene>();
  scene->name = "village";
  scene->meshes = {boxMesh({-500, -1, -500}, {500, 1, 500}), boxMesh({0, 0, 0}, {2, 4, 6}),
                   boxMesh({-1, 0, -1}, {1, 5, 1})};
  scene->prefabs = {{"terrain", "terrain", 0, false}, {"house", "house", 1, true}, {"tree", "tree", 2, true}};
  scene->placements = {{kTerrain, placedAt(0, 0, 0)},
                       {kHouse, placedAt(10, 0, 0)},
                       {kHouse, placedAt(40, 0, 0)},
                       {kTree, placedAt(0, 0, 100)}};
  scene->environment.sun = {{0, -1, 0}, {3, 3, 3}, 0.01f};
  scene->environment.sky = {{0.2f, 0.3f, 0.4f}, {0.1f, 0.1f, 0.1f}};
  scene->cameras.push_back({"front", "", {}, {}});
  return scene;
}

inline Pose poseAt(float x, float z, float scale = 1.0f) {
  Pose pose;
  pose.position = {x, 0.0f, z};
  pose.scale = scale;
  return pose;
}

inline std::span<const std::byte> bytesOf(const std::string& text) { return std::as_bytes(std::span(text)); }

/// Resolves and applies; the test fails when either does.
inline Batch mustApply(World& world, const std::vector<Edit>& edits) {
  Result<Batch> batch = world.resolve(edits);
  EXPECT_TRUE(batch.ok()) << batch.error().message;
  if (!batch) return {};
  const Result<void> applied = world.apply(world.seq() + 1, *batch);
  EXPECT_TRUE(applied.ok()) << applied.error().message;
  return *batch;
}

inline std::vector<InstanceId> idsIn(const World& world, glm::vec2 centre = {0, 0}, float radius = 1e6f) {
  std::vector<InstanceId> ids;
  for (const Found& found : world.query(centre, radius, 0, SIZE_MAX)) ids.push_back(found.id);
  return ids;
}

inline bool operator==(const Pose& a, const Pose& b) {
  return a.position == b.position && a.rotation == b.rotation && a.scale == b.scale;
}

}  // namespace helio::world
