// Mesh::finish, bounds and look-up: the small helpers that every scene relies on.
#include <cmath>

#include <gtest/gtest.h>

#include "scene/scene.h"

namespace helio::scene {
namespace {

/// A square in the plane z = 0 that faces +z, with an image upright on it (v runs down).
Mesh uprightSquare() {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}};
  mesh.uvs = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
  mesh.indices = {0, 1, 2, 0, 2, 3};
  mesh.submeshes = {{0, 6, 0}};
  return mesh;
}

TEST(MeshFinish, NormalsFollowTheWinding) {
  Mesh mesh = uprightSquare();
  mesh.finish();
  for (const glm::vec3& n : mesh.normals) EXPECT_EQ(n, glm::vec3(0, 0, 1));
  mesh = uprightSquare();
  mesh.indices = {0, 2, 1, 0, 3, 2};
  mesh.finish();
  for (const glm::vec3& n : mesh.normals) EXPECT_EQ(n, glm::vec3(0, 0, -1));
}

TEST(MeshFinish, NormalsAreWeightedByArea) {
  Mesh mesh;  // a floor triangle of area 8 and a wall triangle of area 2 share an edge
  mesh.positions = {{0, 0, 0}, {4, 0, 0}, {0, 0, -4}, {4, 1, 0}};
  mesh.indices = {0, 1, 2, 0, 3, 1};
  mesh.finish();
  const glm::vec3 expected = glm::normalize(glm::vec3(0, 16, 0) + glm::cross(glm::vec3(4, 1, 0), glm::vec3(4, 0, 0)));
  EXPECT_NEAR(glm::dot(mesh.normals[0], expected), 1.0f, 1e-6f);
}

TEST(MeshFinish, TangentsFollowTheImage) {
  Mesh mesh = uprightSquare();
  mesh.finish();
  for (const glm::vec4& t : mesh.tangents) EXPECT_EQ(t, glm::vec4(1, 0, 0, 1));  // cross(n, t) * w is the image's up
  mesh = uprightSquare();
  for (glm::vec2& uv : mesh.uvs) uv.x = 1.0f - uv.x;  // mirrored
  mesh.finish();
  for (const glm::vec4& t : mesh.tangents) EXPECT_EQ(t, glm::vec4(-1, 0, 0, -1));
}

TEST(MeshFinish, DegenerateInputStillGivesFrames) {
  Mesh mesh;
  mesh.positions = {{1, 1, 1}, {1, 1, 1}, {1, 1, 1}, {5, 5, 5}};  // a point for a triangle, and an unused vertex
  mesh.indices = {0, 1, 2};
  mesh.finish();
  ASSERT_EQ(mesh.normals.size(), 4u);
  ASSERT_EQ(mesh.tangents.size(), 4u);
  for (size_t i = 0; i < 4; ++i) {
    const glm::vec3 t(mesh.tangents[i]);
    EXPECT_NEAR(glm::length(mesh.normals[i]), 1.0f, 1e-6f);
    EXPECT_NEAR(glm::length(t), 1.0f, 1e-6f);
    EXPECT_NEAR(glm::dot(mesh.normals[i], t), 0.0f, 1e-6f);
    EXPECT_EQ(std::abs(mesh.tangents[i].w), 1.0f);
  }
}

TEST(MeshFinish, KeepsWhatIsThere) {
  Mesh mesh = uprightSquare();
  mesh.normals.assign(4, glm::vec3(0, 1, 0));
  mesh.tangents.assign(4, glm::vec4(0, 0, 1, -1));
  mesh.finish();
  EXPECT_EQ(mesh.normals[2], glm::vec3(0, 1, 0));
  EXPECT_EQ(mesh.tangents[2], glm::vec4(0, 0, 1, -1));
  EXPECT_EQ(mesh.bounds.min, glm::vec3(0));
  EXPECT_EQ(mesh.bounds.max, glm::vec3(2, 2, 0));
}

TEST(AabbTransform, HoldsTheTransformedCorners) {
  const Aabb box{{-1, 0, 2}, {3, 1, 4}};
  const glm::mat4x3 m{{0, 2, 0}, {-1, 0, 0.5f}, {0, 0, -3}, {10, 20, 30}};
  Aabb corners;
  for (int i = 0; i < 8; ++i) {
    const glm::vec4 p((i & 1) ? box.max.x : box.min.x, (i & 2) ? box.max.y : box.min.y, (i & 4) ? box.max.z : box.min.z,
                      1);
    corners.grow(m * p);
  }
  const Aabb result = transform(box, m);
  EXPECT_EQ(result.min, corners.min);
  EXPECT_EQ(result.max, corners.max);
  EXPECT_TRUE(transform(Aabb{}, m).empty());
}

TEST(Scene, BoundsAndLookUp) {
  Scene scene;
  scene.meshes.push_back(uprightSquare());
  scene.meshes.back().finish();
  scene.prefabs = {{"a", "model", 0, true}, {"b", "model", 0, true}};
  EXPECT_TRUE(scene.bounds().empty());
  scene.placements = {{1, {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {10, 0, 0}}},
                      {0, {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, -5, 0}}}};
  EXPECT_EQ(scene.bounds().min, glm::vec3(0, -5, 0));
  EXPECT_EQ(scene.bounds().max, glm::vec3(12, 2, 0));
  EXPECT_EQ(scene.findPrefab("b"), 1u);
  EXPECT_EQ(scene.findPrefab("c"), kNone);
}

}  // namespace
}  // namespace helio::scene
