// Trees, hedges and bushes: opaque, a few hundred triangles, shaped so that leaves' texture and bumps do the rest.
#include <algorithm>

#include "scene/catalogue.h"
#include "scene/mesh_builder.h"
#include "scene/random.h"

namespace helio::scene {
namespace {

using glm::vec3;

struct BroadleafShape {
  const char* name;
  uint32_t foliage, bark;
  float height;  ///< metres to the top
  float crown;   ///< radius of the crown in metres
  float trunk;   ///< radius at the ground in metres
  float clear;   ///< height of the crown's lower edge as a part of the height
  int clumps;    ///< balls around the middle one
  uint64_t seed;
};

/// A trunk, and a crown of one large lumpy ball with smaller ones around its upper half.
Mesh broadleaf(const Palette& p, const BroadleafShape& s) {
  MeshBuilder b(s.name, p);
  Random random(s.seed);
  const float low = s.clear * s.height, middle = 0.5f * (low + s.height), half = 0.5f * (s.height - low);
  b.frustum(s.bark, {0.0f, -0.6f, 0.0f}, s.trunk * 1.25f, s.trunk * 0.6f, 0.6f + middle, 6);
  std::vector<Blob> crown{{{0.0f, middle, 0.0f}, {0.78f * s.crown, half, 0.78f * s.crown}, 1, 0.13f, s.seed}};
  for (int i = 0; i < s.clumps; ++i) {
    const glm::dvec2 d = unitVector((i + 0.35 * random.uniform()) / s.clumps);
    const float reach = s.crown * random.uniform(0.42f, 0.56f), size = s.crown * random.uniform(0.42f, 0.58f);
    const float y = middle + half * random.uniform(-0.4f, 0.5f);
    crown.push_back({{static_cast<float>(d.x) * reach, y, static_cast<float>(d.y) * reach},
                     {size, std::min(size * 0.9f, half * 0.7f), size},
                     i % 2 == 0 ? 1 : 0,
                     0.13f,
                     s.seed * 31 + static_cast<uint64_t>(i)});
  }
  b.blobs(s.foliage, crown);
  return b.build();
}

struct ConiferShape {
  const char* name;
  uint32_t needles, bark;
  float height, radius;
  float clear;  ///< height of the lowest branches in metres
  int tiers, sides;
  uint64_t seed;
};

/// Tiers of drooping branches: each a cone with an uneven, star-shaped hem and a shaded underside.
Mesh conifer(const Palette& p, const ConiferShape& s) {
  MeshBuilder b(s.name, p);
  Random random(s.seed);
  b.frustum(s.bark, {0.0f, -0.6f, 0.0f}, 0.035f * s.height * 0.6f, 0.02f, 0.6f + 0.9f * s.height, 5);
  const float span = s.height - s.clear;
  for (int tier = 0; tier < s.tiers; ++tier) {
    const float t = static_cast<float>(tier) / static_cast<float>(s.tiers);
    const float radius = s.radius * (1.0f - 0.88f * t);
    const float hem = s.clear + span * t * 0.92f,
                apex = std::min(s.height, hem + span * (1.38f / static_cast<float>(s.tiers)) + 0.3f);
    std::vector<vec3> rim;
    for (int i = 0; i < s.sides; ++i) {
      const glm::dvec2 d = unitVector((i + 0.3 * random.uniform() + 0.5 * (tier % 2)) / s.sides);
      const float r = radius * (i % 2 == 0 ? 1.0f : 0.74f) * random.uniform(0.9f, 1.08f);
      rim.push_back({static_cast<float>(d.x) * r, hem - 0.18f * r + (i % 2 == 0 ? 0.0f : 0.12f * radius),
                     -static_cast<float>(d.y) * r});
    }
    const vec3 top(0.0f, apex, 0.0f), under(0.0f, hem + 0.12f * radius, 0.0f);
    for (int i = 0; i < s.sides; ++i) {
      const vec3 left = rim[static_cast<size_t>(i)], right = rim[static_cast<size_t>((i + 1) % s.sides)];
      b.triangle(s.needles, left, right, top);
      b.triangle(s.needles, right, left, under);
    }
  }
  return b.build();
}

/// A pine: a bare stem with flat clouds of needles at its top.
Mesh pine(const Palette& p, uint64_t seed) {
  MeshBuilder b("tree_pine", p);
  Random random(seed);
  b.frustum(p.bark[0], {0.0f, -0.6f, 0.0f}, 0.34f, 0.14f, 11.0f, 6);
  std::vector<Blob> crown;
  for (int i = 0; i < 5; ++i) {
    const glm::dvec2 d = unitVector(0.38 * i + 0.1 * random.uniform());
    const float r = i == 4 ? 0.1f : 1.4f, y = 7.6f + 0.95f * static_cast<float>(i);
    const float rx = random.uniform(1.7f, 2.2f), rz = random.uniform(1.7f, 2.2f);
    crown.push_back({{static_cast<float>(d.x) * r, y, static_cast<float>(d.y) * r},
                     {rx, 0.85f, rz},
                     i % 2,
                     0.18f,
                     seed + static_cast<uint64_t>(i)});
  }
  b.blobs(p.needles[2], crown);
  return b.build();
}

/// A Lombardy poplar or a clipped cypress: one tall ball on a short stem.
Mesh column(const Palette& p, const char* name, uint32_t foliage, float height, float radius, uint64_t seed) {
  MeshBuilder b(name, p);
  b.frustum(p.bark[0], {0.0f, -0.6f, 0.0f}, 0.28f, 0.2f, 2.4f, 6);
  b.blobs(foliage, {{{0.0f, 0.5f * height + 0.5f, 0.0f}, {radius, 0.5f * height - 0.5f, radius}, 1, 0.13f, seed},
                    {{0.12f * radius, 0.36f * height, 0.2f * radius},
                     {1.12f * radius, 0.26f * height, 1.1f * radius},
                     1,
                     0.15f,
                     seed + 1}});
  return b.build();
}

Mesh hedge(const Palette& p) {
  MeshBuilder b("hedge", p);
  // A long box with a softened top, 3 m by 0.9 m by 1.3 m.
  const float x = 1.5f, z = 0.45f, zt = 0.34f, low = -0.5f, shoulder = 1.1f, top = 1.3f;
  const uint32_t m = p.foliage[5];
  for (const float s : {1.0f, -1.0f}) {
    b.quad(m, {-s * x, low, s * z}, {s * x, low, s * z}, {s * x, shoulder, s * z}, {-s * x, shoulder, s * z});
    b.quad(m, {-s * x, shoulder, s * z}, {s * x, shoulder, s * z}, {s * x, top, s * zt}, {-s * x, top, s * zt});
    b.polygon(m, {{s * x, low, s * z},
                  {s * x, low, -s * z},
                  {s * x, shoulder, -s * z},
                  {s * x, top, -s * zt},
                  {s * x, top, s * zt},
                  {s * x, shoulder, s * z}});
  }
  b.quad(m, {-x, top, zt}, {x, top, zt}, {x, top, -zt}, {-x, top, -zt});
  return b.build();
}

Mesh bush(const Palette& p) {
  MeshBuilder b("bush", p);
  b.blob(p.foliage[0], {{0.0f, 0.55f, 0.0f}, {0.95f, 0.8f, 0.9f}, 1, 0.2f, 7});
  b.blob(p.foliage[4], {{0.7f, 0.4f, 0.3f}, {0.6f, 0.6f, 0.6f}, 0, 0.2f, 8});
  return b.build();
}

}  // namespace

void addNature(Catalogue& catalogue) {
  const Palette& p = catalogue.palette;
  const auto& f = p.foliage;
  const uint32_t brown = p.bark[0], white = p.bark[1];
  const auto add = [&](Mesh mesh, bool is_conifer, bool garden, float weight) {
    catalogue.trees.push_back({catalogue.add(std::move(mesh), "tree"), is_conifer, garden, weight});
  };
  for (const auto& [shape, garden, weight] : std::initializer_list<std::tuple<BroadleafShape, bool, float>>{
           {{"tree_oak", f[0], brown, 11.5f, 4.6f, 0.42f, 0.24f, 5, 101}, false, 1.2f},
           {{"tree_oak_old", f[0], brown, 13.5f, 5.8f, 0.60f, 0.22f, 6, 102}, false, 0.5f},
           {{"tree_linden", f[1], brown, 9.5f, 3.3f, 0.30f, 0.26f, 3, 103}, true, 1.0f},
           {{"tree_linden_young", f[1], brown, 6.6f, 2.2f, 0.18f, 0.30f, 3, 104}, true, 1.0f},
           {{"tree_birch", f[2], white, 10.0f, 2.4f, 0.17f, 0.26f, 3, 105}, true, 0.9f},
           {{"tree_maple", f[3], brown, 9.0f, 3.5f, 0.30f, 0.25f, 3, 106}, true, 0.16f},
           {{"tree_beech", f[4], brown, 12.5f, 4.2f, 0.36f, 0.20f, 5, 107}, false, 1.2f},
           {{"tree_copper_beech", f[6], brown, 10.5f, 4.0f, 0.36f, 0.20f, 4, 108}, true, 0.10f},
           {{"tree_apple", f[4], brown, 4.4f, 2.0f, 0.16f, 0.32f, 3, 109}, true, 0.9f}}) {
    add(broadleaf(p, shape), false, garden, weight);
  }
  for (const auto& [shape, weight] : std::initializer_list<std::pair<ConiferShape, float>>{
           {{"tree_spruce", p.needles[0], brown, 15.5f, 3.3f, 1.2f, 6, 12, 201}, 1.2f},
           {{"tree_spruce_tall", p.needles[0], brown, 19.0f, 3.6f, 2.2f, 6, 12, 202}, 0.7f},
           {{"tree_spruce_young", p.needles[0], brown, 8.0f, 2.4f, 0.5f, 4, 10, 203}, 0.8f},
           {{"tree_fir", p.needles[1], brown, 14.0f, 3.8f, 1.0f, 5, 12, 204}, 0.8f}}) {
    add(conifer(p, shape), true, false, weight);
  }
  add(pine(p, 301), true, false, 0.7f);
  add(column(p, "tree_poplar", f[1], 14.0f, 1.5f, 302), false, false, 0.0f);
  add(column(p, "tree_cypress", p.needles[0], 7.0f, 0.9f, 303), true, true, 0.0f);
  catalogue.hedge = catalogue.add(hedge(p), "prop");
  catalogue.bush = catalogue.add(bush(p), "prop");
}

}  // namespace helio::scene
