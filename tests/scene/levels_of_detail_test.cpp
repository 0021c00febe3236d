// Levels of detail: ever coarser, as far off as they say, and made of the mesh's own vertices.
#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "scene/catalogue.h"
#include "scene/levels_of_detail.h"

namespace helio::scene {
namespace {

/// A unit sphere in rings; `soup`: every triangle has corners of its own.
Mesh ball(uint32_t rings, bool soup) {
  Mesh mesh;
  const auto at = [rings](uint32_t ring, uint32_t side) {
    if (ring == 0 || ring == rings) return glm::vec3(0.0f, ring == 0 ? 1.0f : -1.0f, 0.0f);
    const float polar = 3.14159265f * static_cast<float>(ring) / static_cast<float>(rings);
    const float around = 6.2831853f * static_cast<float>(side % (2 * rings)) / static_cast<float>(2 * rings);
    return glm::vec3(std::sin(polar) * std::cos(around), std::cos(polar), std::sin(polar) * std::sin(around));
  };
  const auto corner = [&mesh, soup](const glm::vec3& p) {
    if (!soup)
      for (uint32_t i = 0; i < mesh.positions.size(); ++i)
        if (mesh.positions[i] == p) return i;
    mesh.positions.push_back(p);
    mesh.normals.push_back(glm::normalize(p));
    return static_cast<uint32_t>(mesh.positions.size() - 1);
  };
  for (uint32_t r = 0; r < rings; ++r) {
    for (uint32_t s = 0; s < 2 * rings; ++s) {
      const glm::vec3 a = at(r, s), b = at(r + 1, s), c = at(r + 1, s + 1), d = at(r, s + 1);
      if (r + 1 < rings)
        for (const glm::vec3& p : {a, c, b}) mesh.indices.push_back(corner(p));
      if (r > 0)
        for (const glm::vec3& p : {a, d, c}) mesh.indices.push_back(corner(p));
    }
  }
  mesh.submeshes = {{0, static_cast<uint32_t>(mesh.indices.size()), 0}};
  mesh.finish();
  return mesh;
}

void expectSound(const Mesh& mesh) {
  size_t before = mesh.indices.size();
  float error = 0.0f;
  for (const MeshLevel& level : mesh.levels) {
    SCOPED_TRACE(mesh.name + ", " + std::to_string(level.indices.size() / 3) + " triangles");
    EXPECT_LE(static_cast<double>(level.indices.size()), kLevelShare * static_cast<double>(before));
    EXPECT_GE(level.error, error);
    EXPECT_GT(level.error, 0.0f);
    ASSERT_EQ(level.submeshes.size(), mesh.submeshes.size());
    uint32_t next = 0;
    for (size_t g = 0; g < mesh.submeshes.size(); ++g) {
      EXPECT_EQ(level.submeshes[g].material, mesh.submeshes[g].material);
      EXPECT_EQ(level.submeshes[g].whole, mesh.submeshes[g].whole);
      EXPECT_EQ(level.submeshes[g].first_index, next);
      EXPECT_EQ(level.submeshes[g].index_count % 3, 0u);
      next += level.submeshes[g].index_count;
    }
    EXPECT_EQ(next, level.indices.size());
    for (const uint32_t i : level.indices) ASSERT_LT(i, mesh.positions.size());
    before = level.indices.size();
    error = level.error;
  }
}

TEST(LevelsOfDetail, ABallStaysABall) {
  for (const bool soup : {false, true}) {
    for (const Seams seams : {Seams::keep, Seams::cross}) {
      Mesh mesh = ball(16, soup);
      makeLevels(mesh, {Material{}}, seams);
      ASSERT_EQ(mesh.levels.size(), kMostCoarserLevels) << soup;
      expectSound(mesh);
      for (const MeshLevel& level : mesh.levels) {
        // Closed, facing outwards, and nowhere farther inside than it says by much (the error is a mean of a kind).
        double volume = 0.0;
        float deepest = 1.0f;
        for (size_t t = 0; t < level.indices.size(); t += 3) {
          const glm::vec3 &a = mesh.positions[level.indices[t]], &b = mesh.positions[level.indices[t + 1]],
                          &c = mesh.positions[level.indices[t + 2]];
          volume += static_cast<double>(glm::dot(a, glm::cross(b, c))) / 6.0;
          deepest = std::min(deepest, glm::length((a + b + c) / 3.0f));
        }
        EXPECT_GT(volume, 0.55 * 4.18879);
        EXPECT_LT(volume, 4.18879);
        EXPECT_GT(deepest, 1.0f - 4.0f * level.error - 0.02f);
      }
    }
  }
}

TEST(LevelsOfDetail, WhatShinesOrIsMaskedKeepsItsTriangles) {
  Mesh mesh = ball(16, false);
  const uint32_t half = mesh.submeshes[0].index_count / 6 * 3;
  mesh.submeshes = {{0, half, 0}, {half, mesh.submeshes[0].index_count - half, 1}};
  Material lamp, leaf;
  lamp.emission = glm::vec3(1.0f);
  leaf.alpha_cutoff = 0.5f;
  for (const Material& kept : {lamp, leaf}) {
    makeLevels(mesh, {kept, Material{}}, Seams::keep);
    ASSERT_FALSE(mesh.levels.empty());
    for (const MeshLevel& level : mesh.levels) {
      ASSERT_EQ(level.submeshes[0].index_count, half);
      EXPECT_TRUE(std::equal(mesh.indices.begin(), mesh.indices.begin() + half, level.indices.begin()));
      EXPECT_LT(level.submeshes[1].index_count, mesh.submeshes[1].index_count);
    }
  }
}

TEST(LevelsOfDetail, ASeamStaysOneWhereItMust) {
  // Two halves whose texture coordinates lie apart: a triangle that had corners of both would show all between them.
  Mesh mesh = ball(16, true);
  for (size_t v = 0; v < mesh.positions.size(); ++v) {
    const size_t triangle = v / 3 * 3;
    const float middle = mesh.positions[triangle].x + mesh.positions[triangle + 1].x + mesh.positions[triangle + 2].x;
    mesh.uvs[v] = glm::vec2(mesh.positions[v].y, mesh.positions[v].z) * 0.1f + (middle > 0.0f ? 10.0f : 0.0f);
  }
  makeLevels(mesh, {Material{}}, Seams::keep);
  ASSERT_FALSE(mesh.levels.empty());
  for (const MeshLevel& level : mesh.levels)
    for (size_t t = 0; t < level.indices.size(); t += 3)
      for (size_t k = 1; k < 3; ++k)
        EXPECT_LT(glm::distance(mesh.uvs[level.indices[t]], mesh.uvs[level.indices[t + k]]), 1.0f);
}

TEST(LevelsOfDetail, TheCataloguesAreSoundAndWalkersGetVeryCoarse) {
  Catalogue catalogue = makeCatalogue();
  for (const Prefab& prefab : catalogue.prefabs) {
    Mesh& mesh = catalogue.meshes[prefab.mesh];
    const std::vector<uint32_t> indices = mesh.indices;
    makeLevels(mesh, catalogue.palette.materials, Seams::cross);
    EXPECT_EQ(mesh.indices, indices);
    expectSound(mesh);
    if (prefab.category == "walker") {
      ASSERT_EQ(mesh.levels.size(), kMostCoarserLevels);
      EXPECT_LT(mesh.levels.back().indices.size() / 3, 60u);
      EXPECT_LT(mesh.levels.back().error, 0.6f);
    }
    // The same again.
    Mesh again = mesh;
    makeLevels(again, catalogue.palette.materials, Seams::cross);
    ASSERT_EQ(again.levels.size(), mesh.levels.size());
    for (size_t l = 0; l < mesh.levels.size(); ++l) EXPECT_EQ(again.levels[l].indices, mesh.levels[l].indices);
  }
}

/// The height of what is seen from above at a place; minus infinity: nothing.
float topOf(const Mesh& mesh, const std::vector<uint32_t>& indices, const glm::vec2& at) {
  float highest = -std::numeric_limits<float>::infinity();
  for (size_t t = 0; t < indices.size(); t += 3) {
    const glm::vec3 &a = mesh.positions[indices[t]], &b = mesh.positions[indices[t + 1]],
                    &c = mesh.positions[indices[t + 2]];
    const auto side = [&at](const glm::vec3& p, const glm::vec3& q) {
      return (q.x - p.x) * (at.y - p.z) - (q.z - p.z) * (at.x - p.x);
    };
    const float u = side(b, c), v = side(c, a), w = side(a, b);
    if (u < 0.0f && v < 0.0f && w < 0.0f)  // within it, and it faces up
      highest = std::max(highest, (u * a.y + v * b.y + w * c.y) / (u + v + w));
  }
  return highest;
}

TEST(LevelsOfDetail, HousesKeepTheirRoofs) {
  constexpr int kSide = 24;
  Catalogue catalogue = makeCatalogue();
  size_t houses = 0;
  for (const Prefab& prefab : catalogue.prefabs) {
    if (prefab.name.rfind("house_", 0) != 0) continue;
    ++houses;
    Mesh& mesh = catalogue.meshes[prefab.mesh];
    makeLevels(mesh, catalogue.palette.materials, Seams::cross);
    for (const MeshLevel& level : mesh.levels) {
      if (level.error > 5.0f) continue;  // for houses of a few pixels
      int covered = 0, same = 0;
      for (int y = 0; y < kSide; ++y) {
        for (int x = 0; x < kSide; ++x) {
          const glm::vec3 p =
              mesh.bounds.min + mesh.bounds.extent() * glm::vec3((static_cast<float>(x) + 0.5f) / kSide, 0,
                                                                 (static_cast<float>(y) + 0.5f) / kSide);
          const float fine = topOf(mesh, mesh.indices, {p.x, p.z});
          covered += std::isfinite(fine);
          same += std::isfinite(fine) && std::abs(fine - topOf(mesh, level.indices, {p.x, p.z})) < level.error;
        }
      }
      EXPECT_GT(covered, kSide * kSide / 4);
      EXPECT_GT(same, covered * 3 / 4) << prefab.name << ", " << level.indices.size() / 3 << " triangles";
    }
  }
  EXPECT_GT(houses, 10u);
}

TEST(LevelsOfDetail, VerticesOfCoarserLevelsComeFirst) {
  Mesh mesh = ball(16, false);
  EXPECT_TRUE(coarsestFirst(mesh).empty());
  makeLevels(mesh, {Material{}}, Seams::keep);
  const std::vector<uint32_t> order = coarsestFirst(mesh);
  std::vector<uint32_t> sorted = order, place(order.size());
  std::sort(sorted.begin(), sorted.end());
  for (uint32_t i = 0; i < sorted.size(); ++i) {
    ASSERT_EQ(sorted[i], i);  // each once
    place[order[i]] = i;
  }
  uint32_t before = std::numeric_limits<uint32_t>::max();
  for (const MeshLevel& level : mesh.levels) {
    uint32_t count = 0;
    for (const uint32_t v : level.indices) count = std::max(count, place[v] + 1);
    EXPECT_LT(count, before);
    EXPECT_LE(count, level.indices.size());
    before = count;
  }
}

TEST(LevelsOfDetail, SmallMeshesHaveNone) {
  Mesh mesh = ball(4, false);
  ASSERT_LT(mesh.indices.size() / 3, kFewestTrianglesForLevels);
  makeLevels(mesh, {Material{}}, Seams::keep);
  EXPECT_TRUE(mesh.levels.empty());
}

}  // namespace
}  // namespace helio::scene
