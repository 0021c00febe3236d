// Street furniture and what stands on markets and in fields.
#include "scene/catalogue.h"
#include "scene/house_parts.h"
#include "scene/mesh_builder.h"
#include "scene/random.h"

namespace helio::scene {
namespace {

using glm::vec3;

/// A post with a lantern of four panes (eight emissive triangles).
Mesh lantern(const Palette& p) {
  MeshBuilder b("lamp_lantern", p);
  b.prism(p.iron, {0.0f, -0.5f, 0.0f}, 0.16f, 0.11f, 1.1f, 6);
  b.frustum(p.iron, {0.0f, 0.6f, 0.0f}, 0.07f, 0.05f, 2.7f, 6);
  b.prism(p.iron, {0.0f, 3.3f, 0.0f}, 0.09f, 0.17f, 0.08f, 4, true);
  b.setFrame({0.0f, 3.38f, 0.0f});
  for (int side = 0; side < 4; ++side) {
    b.setFrame({0.0f, 3.38f, 0.0f}, side);
    b.quad(p.lamp_light, {-0.11f, 0.0f, 0.11f}, {0.11f, 0.0f, 0.11f}, {0.17f, 0.42f, 0.17f}, {-0.17f, 0.42f, 0.17f});
  }
  b.setFrame();
  b.prism(p.iron, {0.0f, 3.8f, 0.0f}, 0.32f, 0.06f, 0.22f, 4, true);
  b.prism(p.iron, {0.0f, 4.02f, 0.0f}, 0.05f, 0.0f, 0.2f, 4);
  return b.build();
}

/// A lamp for squares and parks: a globe (20 emissive triangles) on a turned post.
Mesh globeLamp(const Palette& p) {
  MeshBuilder b("lamp_globe", p);
  b.prism(p.iron, {0.0f, -0.5f, 0.0f}, 0.20f, 0.13f, 1.0f, 8);
  b.frustum(p.iron, {0.0f, 0.5f, 0.0f}, 0.07f, 0.06f, 2.9f, 6);
  b.frustum(p.iron, {0.0f, 3.4f, 0.0f}, 0.07f, 0.14f, 0.12f, 6);
  b.blob(p.lamp_light, {{0.0f, 3.72f, 0.0f}, vec3(0.24f), 0, 0.0f, 1});
  return b.build();
}

Mesh fountain(const Palette& p) {
  MeshBuilder b("fountain", p);
  const int sides = 12;
  const uint32_t stone = p.ashlar[0], trim = p.trim[1];
  b.prism(p.slabs, {0.0f, -0.8f, 0.0f}, 5.2f, 5.0f, 1.0f, sides);
  // Basin: outer wall, rim, inner wall, water. A ring is (height, radius).
  using Ring = std::pair<float, float>;
  const auto point = [&](int k, Ring ring) {
    const glm::dvec2 d = unitVector(static_cast<double>(k % sides) / sides);
    return vec3(static_cast<float>(d.x) * ring.second, ring.first, -static_cast<float>(d.y) * ring.second);
  };
  const auto band = [&](uint32_t material, Ring low, Ring high) {
    for (int i = 0; i < sides; ++i) {
      b.quad(material, point(i, low), point(i + 1, low), point(i + 1, high), point(i, high));
    }
  };
  band(stone, {0.2f, 3.6f}, {0.85f, 3.7f});
  band(trim, {0.85f, 3.8f}, {1.0f, 3.8f});
  band(trim, {1.0f, 3.8f}, {1.0f, 3.3f});
  band(stone, {1.0f, 3.3f}, {0.3f, 3.3f});
  band(p.water, {0.82f, 3.35f}, {0.82f, 0.4f});
  b.prism(stone, {0.0f, 0.2f, 0.0f}, 0.8f, 0.5f, 1.7f, 8);
  b.prism(trim, {0.0f, 1.9f, 0.0f}, 0.35f, 1.5f, 0.35f, 12, true);
  b.prism(p.water, {0.0f, 2.25f, 0.0f}, 1.38f, 1.38f, 0.03f, 12);
  b.prism(stone, {0.0f, 2.25f, 0.0f}, 0.28f, 0.2f, 1.1f, 8);
  b.prism(trim, {0.0f, 3.35f, 0.0f}, 0.2f, 0.7f, 0.22f, 12, true);
  b.prism(stone, {0.0f, 3.57f, 0.0f}, 0.18f, 0.0f, 0.8f, 8);
  return b.build();
}

Mesh stall(const Palette& p, const char* name, uint32_t canvas, uint32_t goods) {
  MeshBuilder b(name, p);
  for (const float x : {-1.35f, 1.35f}) {
    for (const float z : {-0.9f, 0.9f}) {
      b.box(p.planks[0], {x - 0.05f, -0.4f, z - 0.05f}, {x + 0.05f, 2.2f, z + 0.05f}, kNoBottom | kNoTop);
    }
  }
  b.box(p.planks[0], {-1.3f, 0.3f, 0.1f}, {1.3f, 0.9f, 0.85f});
  for (int i = 0; i < 3; ++i) {
    const float x = -0.85f + 0.85f * static_cast<float>(i);
    b.box(p.planks[1], {x - 0.36f, 0.9f, 0.2f}, {x + 0.36f, 1.05f, 0.75f}, kNoBottom);
    b.blob(goods, {{x, 1.05f, 0.48f}, {0.32f, 0.16f, 0.24f}, 0, 0.1f, static_cast<uint64_t>(i + 3)});
  }
  // Ridged canvas with a hem all around
  const float x = 1.65f, z = 1.25f, low = 2.1f, ridge = 2.85f;
  for (const float s : {1.0f, -1.0f}) {
    b.quad(canvas, {-s * x, low, s * z}, {s * x, low, s * z}, {s * x, ridge, 0.0f}, {-s * x, ridge, 0.0f});
    b.quad(canvas, {s * x, low - 0.05f, s * z}, {-s * x, low - 0.05f, s * z}, {-s * x, ridge - 0.05f, 0.0f},
           {s * x, ridge - 0.05f, 0.0f});
    b.box(canvas, {-x, low - 0.25f, s * z - 0.02f}, {x, low + 0.0f, s * z + 0.02f});
    b.triangle(canvas, {s * x, low, s * z}, {s * x, low, -s * z}, {s * x, ridge, 0.0f});
    b.triangle(canvas, {s * (x - 0.03f), low, -s * z}, {s * (x - 0.03f), low, s * z}, {s * (x - 0.03f), ridge, 0.0f});
  }
  return b.build();
}

Mesh bench(const Palette& p) {
  MeshBuilder b("bench", p);
  for (const float x : {-0.7f, 0.7f}) b.box(p.iron, {x - 0.04f, -0.3f, -0.22f}, {x + 0.04f, 0.42f, 0.22f}, kNoBottom);
  for (const float z : {-0.14f, 0.02f, 0.18f})
    b.box(p.planks[0], {-0.95f, 0.42f, z - 0.065f}, {0.95f, 0.47f, z + 0.065f});
  for (const float y : {0.62f, 0.80f}) b.box(p.planks[0], {-0.95f, y, -0.30f}, {0.95f, y + 0.11f, -0.26f});
  return b.build();
}

Mesh planter(const Palette& p) {
  MeshBuilder b("planter", p);
  b.prism(p.trim[1], {0.0f, -0.3f, 0.0f}, 0.5f, 0.65f, 0.9f, 8);
  b.blob(p.foliage[4], {{0.0f, 0.75f, 0.0f}, {0.6f, 0.4f, 0.6f}, 1, 0.18f, 5});
  for (int i = 0; i < 3; ++i) {
    const float x = -0.3f + 0.3f * static_cast<float>(i), z = i == 1 ? 0.35f : -0.1f;
    b.blob(p.flowers, {{x, 1.0f, z}, vec3(0.18f), 0, 0.2f, static_cast<uint64_t>(i + 20)});
  }
  return b.build();
}

Mesh barrel(const Palette& p) {
  MeshBuilder b("barrel", p);
  b.frustum(p.planks[0], {0.0f, -0.1f, 0.0f}, 0.28f, 0.36f, 0.55f, 10);
  b.frustum(p.planks[0], {0.0f, 0.45f, 0.0f}, 0.36f, 0.28f, 0.45f, 10);
  return b.build();
}

Mesh crates(const Palette& p) {
  MeshBuilder b("crates", p);
  b.box(p.planks[0], {-0.75f, -0.2f, -0.35f}, {0.0f, 0.6f, 0.35f}, kNoBottom);
  b.box(p.planks[3], {0.06f, -0.2f, -0.4f}, {0.76f, 0.55f, 0.3f}, kNoBottom);
  b.box(p.planks[1], {-0.55f, 0.6f, -0.25f}, {0.05f, 1.1f, 0.3f}, kNoBottom);
  return b.build();
}

Mesh cart(const Palette& p) {
  MeshBuilder b("cart", p);
  b.box(p.planks[0], {-0.8f, 0.75f, -1.3f}, {0.8f, 0.87f, 1.3f});
  for (const float x : {-0.8f, 0.74f}) b.box(p.planks[3], {x, 0.87f, -1.3f}, {x + 0.06f, 1.3f, 1.3f}, kNoBottom);
  b.box(p.planks[3], {-0.74f, 0.87f, -1.3f}, {0.74f, 1.3f, -1.24f}, kNoBottom | kNoLeft | kNoRight);
  b.blob(p.straw, {{0.0f, 1.15f, -0.1f}, {0.72f, 0.55f, 1.1f}, 1, 0.1f, 9});
  for (const float x : {-0.95f, 0.83f}) b.box(p.planks[1], {x, 0.66f, -0.06f}, {x + 0.12f, 0.78f, 0.06f});
  for (const float s : {-1.0f, 1.0f}) {  // wheels: octagonal discs, both faces and the tread
    std::vector<vec3> face, back;
    for (int i = 0; i < 8; ++i) {
      const glm::dvec2 spoke = 0.62 * unitVector(i / 8.0);
      const auto z = static_cast<float>(spoke.x), y = static_cast<float>(0.62 + spoke.y);
      face.push_back({s * 0.98f, y, -s * z});
      back.insert(back.begin(), vec3(s * 0.88f, y, -s * z));
    }
    b.polygon(p.planks[1], face);
    b.polygon(p.planks[1], back);
    for (size_t i = 0; i < 8; ++i) {
      const size_t j = (i + 1) % 8;
      b.quad(p.iron, face[j], face[i], back[7 - i], back[7 - j]);
    }
  }
  b.box(p.planks[0], {-0.5f, 0.78f, 1.3f}, {-0.42f, 0.86f, 2.6f});
  b.box(p.planks[0], {0.42f, 0.78f, 1.3f}, {0.5f, 0.86f, 2.6f});
  return b.build();
}

Mesh hayBale(const Palette& p) {
  MeshBuilder b("hay_bale", p);
  b.frustum(p.straw, {0.0f, -0.3f, 0.0f}, 1.5f, 1.3f, 1.7f, 10);
  b.frustum(p.straw, {0.0f, 1.4f, 0.0f}, 1.5f, 0.0f, 1.5f, 10, true);
  return b.build();
}

Mesh statue(const Palette& p) {
  MeshBuilder b("statue", p);
  b.box(p.ashlar[0], {-1.2f, -0.6f, -1.2f}, {1.2f, 0.4f, 1.2f}, kNoBottom);
  b.box(p.ashlar[0], {-0.8f, 0.4f, -0.8f}, {0.8f, 2.4f, 0.8f}, kNoBottom);
  b.box(p.trim[1], {-0.95f, 2.4f, -0.95f}, {0.95f, 2.6f, 0.95f});
  b.prism(p.copper, {0.0f, 2.6f, 0.0f}, 0.55f, 0.28f, 1.3f, 8);
  b.prism(p.copper, {0.0f, 3.9f, 0.0f}, 0.36f, 0.30f, 0.7f, 8, true);
  b.blob(p.copper, {{0.0f, 4.85f, 0.0f}, {0.2f, 0.26f, 0.2f}, 1, 0.0f, 3});
  b.box(p.copper, {0.25f, 4.2f, -0.1f}, {0.45f, 5.6f, 0.1f});
  return b.build();
}

Mesh well(const Palette& p) {
  MeshBuilder b("well", p);
  b.prism(p.ashlar[1], {0.0f, -0.5f, 0.0f}, 1.0f, 1.0f, 1.3f, 10);
  b.prism(p.water, {0.0f, 0.8f, 0.0f}, 0.75f, 0.75f, 0.02f, 10);
  for (const float x : {-0.85f, 0.85f})
    b.box(p.planks[1], {x - 0.07f, 0.8f, -0.07f}, {x + 0.07f, 2.3f, 0.07f}, kNoBottom);
  gableRoof(b, p.planks[1], p.planks[0], p.planks[1], {2.2f, 1.5f, 2.1f, 0.7f, 0.15f, 0.1f});
  b.box(p.planks[0], {-0.8f, 1.7f, -0.06f}, {0.8f, 1.82f, 0.06f});
  return b.build();
}

Mesh signpost(const Palette& p) {
  MeshBuilder b("signpost", p);
  b.box(p.planks[1], {-0.06f, -0.5f, -0.06f}, {0.06f, 2.5f, 0.06f}, kNoBottom);
  b.box(p.planks[0], {0.0f, 2.0f, 0.07f}, {1.0f, 2.25f, 0.11f});
  b.box(p.planks[0], {-0.9f, 1.65f, -0.11f}, {0.1f, 1.9f, -0.07f});
  return b.build();
}

/// 3 m of pickets.
Mesh fence(const Palette& p) {
  MeshBuilder b("fence", p);
  for (int i = 0; i < 4; ++i) {
    const float x = -1.5f + static_cast<float>(i);
    b.box(p.planks[3], {x - 0.06f, -0.5f, -0.06f}, {x + 0.06f, 1.15f, 0.06f}, kNoBottom);
  }
  for (const float y : {0.4f, 0.85f}) b.box(p.planks[3], {-1.5f, y, 0.065f}, {1.56f, y + 0.12f, 0.10f});
  return b.build();
}

Mesh stoneWall(const Palette& p) {
  MeshBuilder b("stone_wall", p);
  b.box(p.ashlar[1], {-1.5f, -0.8f, -0.22f}, {1.5f, 1.0f, 0.22f}, kNoBottom | kNoTop);
  b.box(p.trim[1], {-1.52f, 0.98f, -0.28f}, {1.52f, 1.12f, 0.28f});
  return b.build();
}

}  // namespace

void addProps(Catalogue& c) {
  const Palette& p = c.palette;
  c.lantern = c.add(lantern(p), "lamp");
  c.globe_lamp = c.add(globeLamp(p), "lamp");
  c.fountain = c.add(fountain(p), "prop");
  c.stalls = {c.add(stall(p, "market_stall_red", p.stripes[0], p.fruit_orange), "prop"),
              c.add(stall(p, "market_stall_green", p.stripes[1], p.fruit_red), "prop"),
              c.add(stall(p, "market_stall_blue", p.stripes[2], p.straw), "prop"),
              c.add(stall(p, "market_stall_yellow", p.stripes[3], p.flowers), "prop")};
  c.bench = c.add(bench(p), "prop");
  c.planter = c.add(planter(p), "prop");
  c.barrel = c.add(barrel(p), "prop");
  c.crates = c.add(crates(p), "prop");
  c.cart = c.add(cart(p), "prop");
  c.hay_bale = c.add(hayBale(p), "prop");
  c.statue = c.add(statue(p), "prop");
  c.well = c.add(well(p), "prop");
  c.signpost = c.add(signpost(p), "prop");
  c.fence = c.add(fence(p), "prop");
  c.stone_wall = c.add(stoneWall(p), "prop");
}

}  // namespace helio::scene
