#include "scene/cut_outs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "scene/triangle_order.h"
#include "support/scenes.h"

namespace helio::scene {
namespace {

Texture noise(uint32_t width, uint32_t height, Wrap u, Wrap v, std::mt19937& random) {
  Texture texture{"noise", width, height, {}, true, {false, u, v}};
  std::uniform_int_distribution<int> byte(0, 255);
  for (uint32_t i = 0; i < 4 * width * height; ++i) texture.rgba.push_back(static_cast<uint8_t>(byte(random)));
  return texture;
}

/// A bilinear read as the graphics API defines it.
float read(const Texture& texture, const glm::vec2& uv) {
  const auto texel = [&](int64_t i, uint32_t size, Wrap wrap) {
    const auto n = static_cast<int64_t>(size);
    if (wrap == Wrap::clamp) return std::min(std::max<int64_t>(i, 0), n - 1);
    if (wrap == Wrap::repeat) return ((i % n) + n) % n;
    const int64_t m = ((i % (2 * n)) + 2 * n) % (2 * n);
    return m < n ? m : 2 * n - 1 - m;
  };
  const glm::dvec2 p = glm::dvec2(uv) * glm::dvec2(texture.width, texture.height) - 0.5;
  const auto x = static_cast<int64_t>(std::floor(p.x)), y = static_cast<int64_t>(std::floor(p.y));
  const auto at = [&](int64_t i, int64_t j) {
    const auto row = static_cast<size_t>(texel(j, texture.height, texture.sampling.v));
    return texture
        .rgba[4 * (row * texture.width + static_cast<size_t>(texel(i, texture.width, texture.sampling.u))) + 3];
  };
  const double fx = p.x - std::floor(p.x), fy = p.y - std::floor(p.y);
  const double above = at(x, y) * (1.0 - fx) + at(x + 1, y) * fx;
  const double below = at(x, y + 1) * (1.0 - fx) + at(x + 1, y + 1) * fx;
  return static_cast<float>((above * (1.0 - fy) + below * fy) / 255.0);
}

// No read within a triangle may lie outside of the range that was found for it, and ranges must not be idle.
TEST(CutOuts, RangesHoldWhateverIsRead) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> anywhere(-1.5f, 2.5f), small(-0.1f, 0.1f), unit(0.0f, 1.0f);
  size_t narrow = 0;
  for (int round = 0; round < 300; ++round) {
    const Texture texture = noise(5 + static_cast<uint32_t>(round) % 9, 4 + static_cast<uint32_t>(round) % 5,
                                  static_cast<Wrap>(round % 3), static_cast<Wrap>(round / 3 % 3), random);
    const glm::vec2 first(anywhere(random), anywhere(random));
    std::array<glm::vec2, 3> uv{first, first, first};
    for (size_t i = 1; i < 3; ++i)
      uv[i] += round % 2 ? glm::vec2(small(random), small(random)) : glm::vec2(anywhere(random), anywhere(random));
    const AlphaRange range = alphaWithin(texture, uv);
    narrow += range.greatest - range.least < 0.9f;
    for (int k = 0; k < 200; ++k) {
      const float a = std::sqrt(unit(random)), b = unit(random);
      const float alpha = read(texture, uv[0] * (1.0f - a) + uv[1] * (a * (1.0f - b)) + uv[2] * (a * b));
      ASSERT_GE(alpha, range.least - 1e-4f) << "round " << round;
      ASSERT_LE(alpha, range.greatest + 1e-4f) << "round " << round;
    }
  }
  EXPECT_GT(narrow, 50u);
}

TEST(CutOuts, SplitsWholeFromCutAndDropsTheRest) {
  // A strip of alpha 0 beside one of alpha 1, and three quads: on the one, on the other, across both.
  Texture texture{"halves", 16, 1, {}, true, {}};
  for (uint32_t i = 0; i < 16; ++i)
    texture.rgba.insert(texture.rgba.end(), {0, 0, 0, static_cast<uint8_t>(i < 8 ? 0 : 255)});
  Mesh mesh;
  for (const float u : {0.2f, 0.7f, 0.45f}) {
    const auto first = static_cast<uint32_t>(mesh.positions.size());
    for (const glm::vec2 corner : {glm::vec2(0, 0), glm::vec2(0, 1), glm::vec2(1, 1), glm::vec2(1, 0)}) {
      mesh.positions.emplace_back(corner.x, 0.0f, corner.y);
      mesh.uvs.emplace_back(u + 0.1f * corner.x, corner.y);
    }
    for (const uint32_t i : {0u, 1u, 2u, 0u, 2u, 3u}) mesh.indices.push_back(first + i);
  }
  mesh.submeshes = {{0, 18, 0}};
  mesh.finish();
  Material material;
  material.base_color_texture = 0;
  material.alpha_cutoff = 0.5f;
  Mesh split = mesh;
  splitCutOuts(split, {material}, {texture});
  ASSERT_EQ(split.submeshes.size(), 2u);
  EXPECT_TRUE(split.submeshes[0].whole);
  EXPECT_FALSE(split.submeshes[1].whole);
  EXPECT_EQ(split.submeshes[0].index_count, 6u);
  EXPECT_EQ(split.submeshes[1].index_count, 6u);
  EXPECT_EQ(split.indices[0], 4u) << "the quad on alpha 1";
  EXPECT_EQ(split.indices[6], 8u) << "the quad across";

  // Without a mask nothing is touched; a mask over vertex colours' alpha drops what is below it.
  Mesh opaque = mesh;
  splitCutOuts(opaque, {Material{}}, {texture});
  EXPECT_EQ(opaque.indices, mesh.indices);
  EXPECT_EQ(opaque.submeshes.size(), 1u);
  material.base_color_texture = kNone;
  mesh.colors.assign(mesh.positions.size(), glm::vec4(1.0f));
  for (size_t i = 0; i < 4; ++i) mesh.colors[i].a = 0.2f;
  splitCutOuts(mesh, {material}, {});
  ASSERT_EQ(mesh.submeshes.size(), 1u);
  EXPECT_TRUE(mesh.submeshes[0].whole);
  EXPECT_EQ(mesh.submeshes[0].index_count, 12u);
}

// The same triangles, and halves of halves in smaller boxes than before.
TEST(TriangleOrder, KeepsTrianglesAndShrinksBoxes) {
  Mesh mesh = test::sphere(24);
  mesh.submeshes = {{0, 1500, 0}, {1500, static_cast<uint32_t>(mesh.indices.size()) - 1500, 1}};
  mesh.finish();
  std::mt19937 random(2);  // in no order
  std::vector<std::array<uint32_t, 3>> triangles(mesh.indices.size() / 3);
  for (size_t t = 0; t < triangles.size(); ++t) std::copy_n(&mesh.indices[3 * t], 3, triangles[t].begin());
  std::shuffle(triangles.begin(), triangles.begin() + 500, random);
  std::shuffle(triangles.begin() + 500, triangles.end(), random);
  for (size_t t = 0; t < triangles.size(); ++t) std::copy_n(triangles[t].begin(), 3, &mesh.indices[3 * t]);

  const auto sorted = [](const Mesh& m, size_t first, size_t last) {
    std::vector<std::array<uint32_t, 3>> list;
    for (size_t t = first; t < last; ++t)
      list.push_back({m.indices[3 * t], m.indices[3 * t + 1], m.indices[3 * t + 2]});
    std::sort(list.begin(), list.end());
    return list;
  };
  const auto area = [](const Mesh& m) {  // of the boxes of sixteenths
    double sum = 0.0;
    const size_t count = m.indices.size() / 3;
    for (size_t part = 0; part < 16; ++part) {
      Aabb box;
      for (size_t i = 3 * (count * part / 16); i < 3 * (count * (part + 1) / 16); ++i)
        box.grow(m.positions[m.indices[i]]);
      const glm::dvec3 e(box.extent());
      sum += e.x * e.y + e.y * e.z + e.z * e.x;
    }
    return sum;
  };
  Mesh ordered = mesh, again = mesh;
  orderTriangles(ordered);
  orderTriangles(again);
  EXPECT_EQ(ordered.indices, again.indices);
  EXPECT_EQ(sorted(ordered, 0, 500), sorted(mesh, 0, 500)) << "each submesh keeps its own";
  EXPECT_EQ(sorted(ordered, 500, triangles.size()), sorted(mesh, 500, triangles.size()));
  EXPECT_LT(area(ordered), 0.4 * area(mesh));
}

}  // namespace
}  // namespace helio::scene
