// The generated city: the same bytes for the same parameters, sound geometry, things that stand where things can stand.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <set>

#include <gtest/gtest.h>

#include "city_probe.h"

namespace helio::scene {
namespace {

constexpr double kHitboxCell = 16.0;

bool finite(const glm::vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

std::vector<Placement> placementsOf(const Scene& scene, const std::set<std::string>& categories) {
  std::vector<Placement> result;
  for (const Placement& p : scene.placements) {
    if (categories.count(scene.prefabs[p.prefab].category)) result.push_back(p);
  }
  return result;
}

TEST(City, SameParametersSameBytes) {
  const Result<ScenePtr> again = generateCity({1, 1'000});
  ASSERT_TRUE(again);
  const uint64_t hash = hashScene(cityOf(1, 1'000));
  EXPECT_EQ(hash, hashScene(**again));
  EXPECT_NE(hash, hashScene(cityOf(2, 1'000)));
  EXPECT_NE(hash, hashScene(cityOf(1, 1'001)));
}

TEST(City, RefusesCountsOutOfRange) {
  for (uint32_t count : {0u, 999u, 1'000'001u, 0xffffffffu}) {
    const Result<ScenePtr> result = generateCity({1, count});
    ASSERT_FALSE(result) << count;
    EXPECT_EQ(result.error().kind, ErrorKind::invalid);
    EXPECT_EQ(result.error().field, "instances");
    EXPECT_EQ(result.error().value, std::to_string(count));
  }
}

/// Everything that must hold for a city of any size.
class CityOfSize : public testing::TestWithParam<std::pair<uint64_t, uint32_t>> {
 protected:
  const Scene& scene() const { return cityOf(GetParam().first, GetParam().second); }
};

TEST_P(CityOfSize, HasExactlyTheInstancesAskedFor) { EXPECT_EQ(scene().placements.size(), GetParam().second); }

/// Prints the row of server/scene/README.md for its size.
TEST_P(CityOfSize, Figures) {
  const Scene& s = scene();
  double side = 0.0, triangles = 0.0;
  std::map<std::string, size_t> placed;
  for (const Placement& p : s.placements) {
    const Prefab& prefab = s.prefabs[p.prefab];
    const Mesh& mesh = s.meshes[prefab.mesh];
    ++placed[prefab.category];
    triangles += static_cast<double>(mesh.indices.size()) / 3.0;
    if (prefab.category == "terrain" && mesh.bounds.extent().x < 65.0f) {
      side = std::max({side, 2.0 * std::abs(p.transform[3].x) + 64.0, 2.0 * std::abs(p.transform[3].z) + 64.0});
    }
  }
  const auto count = static_cast<double>(s.placements.size());
  const double density = count / ((side / kHitboxCell) * (side / kHitboxCell)), mean = triangles / count;
  std::printf("seed %llu | %zu | %.0f m | %.1f | %zu | %zu | %zu | %zu | %.0f |\n",
              static_cast<unsigned long long>(GetParam().first), s.placements.size(), side, density, placed["house"],
              placed["tree"], placed["lamp"], placed["terrain"], mean);
  EXPECT_GT(density, 3.6);
  EXPECT_LT(density, 5.4);
  EXPECT_LT(mean, 300.0);
}

TEST_P(CityOfSize, IndicesAreInRange) {
  const Scene& s = scene();
  std::set<std::string> names;
  for (const Prefab& p : s.prefabs) {
    ASSERT_LT(p.mesh, s.meshes.size());
    EXPECT_TRUE(names.insert(p.name).second) << p.name;
    EXPECT_EQ(p.buildable, p.category != "terrain") << p.name;
  }
  for (const Placement& p : s.placements) ASSERT_LT(p.prefab, s.prefabs.size());
  for (const Material& m : s.materials) {
    for (uint32_t t : {m.base_color_texture, m.normal_texture, m.metallic_roughness_texture, m.emissive_texture}) {
      ASSERT_TRUE(t == kNone || t < s.textures.size()) << m.name;
    }
    EXPECT_TRUE(m.base_color_texture == kNone || s.textures[m.base_color_texture].srgb) << m.name;
    EXPECT_TRUE(m.normal_texture == kNone || !s.textures[m.normal_texture].srgb) << m.name;
  }
  for (const Texture& t : s.textures) EXPECT_EQ(t.rgba.size(), size_t{4} * t.width * t.height) << t.name;
  for (const Mesh& m : s.meshes) {
    uint32_t covered = 0;
    for (const Submesh& sub : m.submeshes) {
      EXPECT_EQ(sub.first_index, covered) << m.name;
      EXPECT_EQ(sub.index_count % 3, 0u) << m.name;
      EXPECT_LT(sub.material, s.materials.size()) << m.name;
      covered += sub.index_count;
    }
    EXPECT_EQ(covered, m.indices.size()) << m.name;
    for (uint32_t i : m.indices) ASSERT_LT(i, m.positions.size()) << m.name;
  }
}

TEST_P(CityOfSize, GeometryIsSound) {
  for (const Mesh& m : scene().meshes) {
    ASSERT_EQ(m.normals.size(), m.positions.size()) << m.name;
    ASSERT_EQ(m.tangents.size(), m.positions.size()) << m.name;
    ASSERT_EQ(m.uvs.size(), m.positions.size()) << m.name;
    for (size_t i = 0; i < m.positions.size(); ++i) {
      const glm::vec3 t(m.tangents[i]), n = m.normals[i];
      ASSERT_TRUE(finite(m.positions[i]) && finite(n) && finite(t)) << m.name;
      ASSERT_TRUE(std::isfinite(m.uvs[i].x) && std::isfinite(m.uvs[i].y)) << m.name;
      ASSERT_NEAR(glm::length(n), 1.0f, 1e-4f) << m.name;
      ASSERT_NEAR(glm::length(t), 1.0f, 1e-4f) << m.name;
      ASSERT_NEAR(glm::dot(n, t), 0.0f, 1e-3f) << m.name;
      ASSERT_EQ(std::abs(m.tangents[i].w), 1.0f) << m.name;
    }
    for (size_t i = 0; i < m.indices.size(); i += 3) {
      const glm::vec3 a = m.positions[m.indices[i]], b = m.positions[m.indices[i + 1]],
                      c = m.positions[m.indices[i + 2]];
      const glm::vec3 doubled_area = glm::cross(b - a, c - a);
      ASSERT_GT(glm::length(doubled_area), 1e-7f) << m.name << " triangle " << i / 3;
      // Shading normals stay on the side that the winding says is outside.
      const glm::vec3 shading = m.normals[m.indices[i]] + m.normals[m.indices[i + 1]] + m.normals[m.indices[i + 2]];
      ASSERT_GT(glm::dot(doubled_area, shading), 0.0f) << m.name << " triangle " << i / 3;
    }
  }
}

TEST_P(CityOfSize, NothingButTerrainAndLandmarksIsWiderThanTwoCells) {
  const Scene& s = scene();
  for (const Placement& p : s.placements) {
    const Prefab& prefab = s.prefabs[p.prefab];
    if (prefab.category == "terrain") continue;
    const glm::vec3 extent = transform(s.meshes[prefab.mesh].bounds, p.transform).extent();
    const float most = prefab.category == "landmark" ? 42.0f : 32.0f;
    ASSERT_LE(std::max(extent.x, extent.z), most) << prefab.name;
  }
}

TEST_P(CityOfSize, HousesStandApart) {
  const Scene& s = scene();
  std::map<std::pair<int, int>, std::vector<Rectangle>> cells;
  for (const Placement& p : placementsOf(s, {"house", "landmark"})) {
    const Rectangle r = footprintOf(s, p);
    const auto x = static_cast<int>(std::floor(r.centre.x / 48.0)), z = static_cast<int>(std::floor(r.centre.y / 48.0));
    for (int dz = -1; dz <= 1; ++dz) {
      for (int dx = -1; dx <= 1; ++dx) {
        for (const Rectangle& other : cells[{x + dx, z + dz}]) {
          ASSERT_FALSE(overlap(r, other))
              << "at " << r.centre.x << ", " << r.centre.y << ": " << s.prefabs[p.prefab].name;
        }
      }
    }
    cells[{x, z}].push_back(r);
  }
}

TEST_P(CityOfSize, HousesStandOnTheGround) {
  constexpr float kFoundationDepth = 3.0f;
  const Scene& s = scene();
  const GroundProbe ground(s);
  size_t checked = 0;
  for (const Placement& p : placementsOf(s, {"house", "landmark"})) {
    if (GetParam().second > 10'000 && checked % 8 != 0) {
      ++checked;
      continue;
    }
    ++checked;
    const Rectangle r = footprintOf(s, p);
    float low = ground.height(r.centre), high = low;
    for (const glm::dvec2& corner : r.corners()) {
      const float h = ground.height(corner);
      low = std::min(low, h);
      high = std::max(high, h);
    }
    const float y = p.transform[3].y;
    const std::string& name = s.prefabs[p.prefab].name;
    ASSERT_LT(y - kFoundationDepth, low) << name << " floats at " << r.centre.x << ", " << r.centre.y;
    ASSERT_LT(y, high + 0.3f) << name << " stands too high at " << r.centre.x << ", " << r.centre.y;
    ASSERT_GT(y + 0.35f, high) << name << " is buried at " << r.centre.x << ", " << r.centre.y;
  }
  EXPECT_GT(checked, 20u);
}

TEST_P(CityOfSize, TreesAndLampsAreRootedInTheGround) {
  const Scene& s = scene();
  const GroundProbe ground(s);
  const std::vector<Placement> things = placementsOf(s, {"tree", "lamp", "prop"});
  for (size_t i = 0; i < things.size(); i += 1 + things.size() / 2'000) {
    const glm::vec3 p = things[i].transform[3];
    ASSERT_NEAR(p.y, ground.height({p.x, p.z}), 0.15f)
        << s.prefabs[things[i].prefab].name << " at " << p.x << ", " << p.z;
  }
}

TEST_P(CityOfSize, TilesAreWatertightAtEveryLevel) {
  // Every edge within a tile belongs to two triangles that run along it in opposite directions: no cracks, no
  // T-junctions. Those along its border are the same at every level, or neighbours would not meet.
  using Point = std::array<int64_t, 3>;
  using Edges = std::map<std::pair<Point, Point>, int>;
  const auto openEdges = [](const Mesh& mesh, const std::vector<uint32_t>& indices) {
    const auto point = [&](uint32_t i) {
      const glm::dvec3 p = glm::dvec3(mesh.positions[i]) * 1000.0;
      return Point{std::llround(p.x), std::llround(p.y), std::llround(p.z)};
    };
    Edges edges;
    for (size_t i = 0; i < indices.size(); i += 3) {
      for (size_t k = 0; k < 3; ++k) {
        const Point a = point(indices[i + k]), b = point(indices[i + (k + 1) % 3]);
        if (a < b) ++edges[{a, b}];
        else --edges[{b, a}];
      }
    }
    std::erase_if(edges, [](const auto& edge) { return edge.second == 0; });
    return edges;
  };
  const auto onBorder = [](const Point& p) { return std::llabs(p[0]) >= 31'999 || std::llabs(p[2]) >= 31'999; };
  const Scene& s = scene();
  size_t tiles = 0, triangles = 0, coarsest = 0;
  for (const Mesh& mesh : s.meshes) {
    if (mesh.name.rfind("terrain_", 0) != 0 || mesh.bounds.extent().x > 65.0f) continue;
    if (++tiles > 400) break;
    const Edges outline = openEdges(mesh, mesh.indices);
    for (const auto& [edge, balance] : outline)
      EXPECT_TRUE(onBorder(edge.first) && onBorder(edge.second)) << mesh.name << " of " << outline.size() << " edges";
    triangles += mesh.indices.size() / 3;
    coarsest += (mesh.levels.empty() ? mesh.indices : mesh.levels.back().indices).size() / 3;
    for (const MeshLevel& level : mesh.levels) {
      EXPECT_EQ(openEdges(mesh, level.indices), outline) << mesh.name << ", level " << &level - mesh.levels.data();
      EXPECT_LT(level.error, 0.5f) << mesh.name;
    }
  }
  EXPECT_GE(tiles, 16u);
  EXPECT_LT(3 * coarsest, triangles);
}

TEST_P(CityOfSize, CamerasSeeTheCity) {
  const Scene& s = scene();
  const GroundProbe ground(s);
  const Aabb world = s.bounds();
  const std::vector<std::string> expected = {"tilted_city", "animated_models", "city_at_sunset",
                                             "high_above",  "forest",          "tilted_forest"};
  std::vector<std::string> names;
  for (const NamedCamera& named : s.cameras) {
    names.push_back(named.name);
    const Camera& c = named.camera;
    EXPECT_NEAR(glm::length(c.forward), 1.0f, 1e-5f) << named.name;
    EXPECT_NEAR(c.vfov, 0.8727f, 0.2f) << named.name;
    EXPECT_TRUE(c.position.x > world.min.x && c.position.x < world.max.x) << named.name;
    EXPECT_TRUE(c.position.z > world.min.z && c.position.z < world.max.z) << named.name;
    EXPECT_GT(c.position.y, ground.height({c.position.x, c.position.z}) + 2.0f) << named.name;
    EXPECT_NEAR(glm::length(named.environment.sun.direction), 1.0f, 1e-5f) << named.name;
  }
  EXPECT_EQ(names, expected);
  // Nothing stands around a camera, nor in the first metres of what it looks at.
  for (const Placement& p : s.placements) {
    const Prefab& prefab = s.prefabs[p.prefab];
    if (prefab.category == "terrain") continue;
    const Aabb box = transform(s.meshes[prefab.mesh].bounds, p.transform);
    for (const NamedCamera& named : s.cameras) {
      for (float t = 0.0f; t <= 10.0f; t += 0.5f) {
        const glm::vec3 eye = named.camera.position + t * named.camera.forward;
        const bool apart =
            glm::any(glm::lessThan(eye, box.min - 0.5f)) || glm::any(glm::greaterThan(eye, box.max + 0.5f));
        ASSERT_TRUE(apart) << named.name << " is blocked by " << prefab.name << " at " << t << " m";
      }
    }
  }
}

TEST_P(CityOfSize, HasWhatACityHas) {
  const Scene& s = scene();
  std::map<std::string, size_t> placed;
  std::set<uint32_t> houses;
  for (const Placement& p : s.placements) {
    ++placed[s.prefabs[p.prefab].category];
    if (s.prefabs[p.prefab].category == "house") houses.insert(p.prefab);
  }
  EXPECT_GE(houses.size(), GetParam().second >= 10'000 ? 30u : 12u);
  EXPECT_GE(placed["house"], GetParam().second / 40);
  EXPECT_GE(placed["tree"], GetParam().second / 4);
  EXPECT_GE(placed["lamp"], GetParam().second / 60);
  EXPECT_GE(placed["landmark"], 3u);
  const uint32_t hall = s.findPrefab("glass_hall");
  ASSERT_NE(hall, kNone);
  EXPECT_TRUE(
      std::any_of(s.placements.begin(), s.placements.end(), [&](const Placement& p) { return p.prefab == hall; }));
}

INSTANTIATE_TEST_SUITE_P(
    Sizes, CityOfSize,
    testing::Values(std::pair<uint64_t, uint32_t>{1, 1'000}, std::pair<uint64_t, uint32_t>{7, 1'000},
                    std::pair<uint64_t, uint32_t>{42, 3'000}, std::pair<uint64_t, uint32_t>{1, 10'000},
                    std::pair<uint64_t, uint32_t>{5, 10'000}, std::pair<uint64_t, uint32_t>{1, 100'000}),
    [](const auto& info) {
      return "seed" + std::to_string(info.param.first) + "_" + std::to_string(info.param.second);
    });

TEST(CityCatalogue, HousesAreManyAndModest) {
  const Scene& s = cityOf(1, 1'000);
  size_t houses = 0;
  for (const Prefab& p : s.prefabs) {
    const size_t triangles = s.meshes[p.mesh].indices.size() / 3;
    if (p.category == "house") {
      ++houses;
      EXPECT_LE(triangles, 850u) << p.name;
    }
    if (p.category == "tree") {
      EXPECT_GE(triangles, 80u) << p.name;
      EXPECT_LE(triangles, 480u) << p.name;
    }
    if (p.category != "lamp") continue;
    size_t emissive = 0;
    for (const Submesh& sub : s.meshes[p.mesh].submeshes) {
      if (s.materials[sub.material].emission != glm::vec3(0.0f)) emissive += sub.index_count / 3;
    }
    EXPECT_GE(emissive, 1u) << p.name;
    EXPECT_LE(emissive, 20u) << p.name;
  }
  EXPECT_GE(houses, 24u);
}

TEST(CityCatalogue, HousesPivotOnTheGround) {
  const Scene& s = cityOf(1, 1'000);
  for (const Prefab& p : s.prefabs) {
    if (p.category != "house") continue;
    const Aabb& box = s.meshes[p.mesh].bounds;
    EXPECT_LT(box.min.y, -1.0f) << p.name;  // foundations reach down
    EXPECT_LT(std::abs(box.centre().x), 1.5f) << p.name;
    EXPECT_LT(std::abs(box.centre().z), 1.5f) << p.name;
  }
}

struct Face {
  std::array<glm::dvec3, 3> p;
  glm::dvec3 normal;
  uint32_t material;
};

std::vector<Face> facesOf(const Mesh& mesh) {
  std::vector<Face> faces;
  for (const Submesh& sub : mesh.submeshes)
    for (uint32_t i = sub.first_index; i < sub.first_index + sub.index_count; i += 3) {
      Face face{{}, {}, sub.material};
      for (uint32_t c = 0; c < 3; ++c) face.p[c] = glm::dvec3(mesh.positions[mesh.indices[i + c]]);
      const glm::dvec3 area = glm::cross(face.p[1] - face.p[0], face.p[2] - face.p[0]);
      if (glm::length(area) < 1e-6) continue;
      face.normal = glm::normalize(area);
      faces.push_back(face);
    }
  return faces;
}

/// The part of `a` that lies above or below `b`, seen along `b`'s normal: a convex polygon in `a`'s plane.
std::vector<glm::dvec3> overlap(const Face& a, const Face& b) {
  std::vector<glm::dvec3> polygon(a.p.begin(), a.p.end());
  for (size_t c = 0; c < 3 && !polygon.empty(); ++c) {
    const glm::dvec3 inward = glm::cross(b.normal, b.p[(c + 1) % 3] - b.p[c]);
    std::vector<glm::dvec3> kept;
    for (size_t i = 0; i < polygon.size(); ++i) {
      const glm::dvec3 from = polygon[i], to = polygon[(i + 1) % polygon.size()];
      const double d0 = glm::dot(inward, from - b.p[c]), d1 = glm::dot(inward, to - b.p[c]);
      if (d0 >= 0.0) kept.push_back(from);
      if ((d0 < 0.0) != (d1 < 0.0)) kept.push_back(from + (to - from) * (d0 / (d0 - d1)));
    }
    polygon = std::move(kept);
  }
  return polygon;
}

double areaOf(const std::vector<glm::dvec3>& polygon) {
  glm::dvec3 twice(0.0);
  for (size_t i = 2; i < polygon.size(); ++i) twice += glm::cross(polygon[i - 1] - polygon[0], polygon[i] - polygon[0]);
  return 0.5 * glm::length(twice);
}

/// A face lies over `point`, less than 20 m away on the side that `normal` tells.
bool covered(const std::vector<Face>& faces, glm::dvec3 point, glm::dvec3 normal) {
  constexpr double kGap = 2e-3, kReach = 20.0;
  return std::any_of(faces.begin(), faces.end(), [&](const Face& face) {
    const double slope = glm::dot(face.normal, normal);
    if (std::abs(slope) < 1e-9) return false;
    const double distance = glm::dot(face.normal, face.p[0] - point) / slope;
    if (distance < kGap || distance > kReach) return false;
    const glm::dvec3 there = point + distance * normal;
    for (size_t c = 0; c < 3; ++c)
      if (glm::dot(glm::cross(face.normal, face.p[(c + 1) % 3] - face.p[c]), there - face.p[c]) < 0.0) return false;
    return true;
  });
}

// Where two materials share a place, whichever the rasteriser or a ray finds first is shown: they need not agree, and
// what looks back sees another surface in each tick.
TEST(CityCatalogue, NoTwoMaterialsShareAPlace) {
  constexpr double kApart = 2e-3, kNotable = 0.02;  // metres, square metres
  const Scene& s = cityOf(1, 1'000);
  for (const Prefab& p : s.prefabs) {
    if (p.category == "terrain") continue;
    const std::vector<Face> faces = facesOf(s.meshes[p.mesh]);
    std::map<std::pair<uint32_t, uint32_t>, double> shared;
    for (size_t i = 0; i < faces.size(); ++i)
      for (size_t k = i + 1; k < faces.size(); ++k) {
        const Face &a = faces[i], &b = faces[k];
        if (a.material == b.material || glm::dot(a.normal, b.normal) < 0.9999) continue;
        if (std::abs(glm::dot(b.normal, a.p[0] - b.p[0])) > kApart) continue;
        const std::vector<glm::dvec3> common = overlap(a, b);
        const double area = areaOf(common);
        if (area < 1e-4) continue;
        glm::dvec3 middle(0.0);
        for (const glm::dvec3& corner : common) middle += corner / static_cast<double>(common.size());
        if (!covered(faces, middle, b.normal)) shared[{a.material, b.material}] += area;
      }
    for (const auto& [materials, area] : shared)
      EXPECT_LT(area, kNotable) << p.name << ": square metres of " << s.materials[materials.first].name << " and "
                                << s.materials[materials.second].name;
  }
}

TEST(CityCatalogue, MaterialsArePhysical) {
  bool mirror = false;
  for (const Material& m : cityOf(1, 1'000).materials) {
    for (int c = 0; c < 3; ++c) {
      EXPECT_GE(m.base_color[c], 0.0f) << m.name;
      EXPECT_LE(m.base_color[c], 1.0f) << m.name;
      EXPECT_LE(m.emission[c], 200.0f) << m.name;
    }
    mirror |= m.metallic == 1.0f && m.roughness == 0.0f;
  }
  EXPECT_TRUE(mirror);
}

TEST(Daylight, NoonIsWhiteAndSunsetIsRed) {
  constexpr float kDegree = 0.017453292f;
  const Environment noon = daylight(60.0f * kDegree, 0.5f), sunset = daylight(4.0f * kDegree, 0.5f);
  EXPECT_NEAR(noon.sun.irradiance.r, 20.0f, 1.0f);
  EXPECT_NEAR(noon.sun.irradiance.g, 19.0f, 1.0f);
  EXPECT_NEAR(noon.sun.irradiance.b, 17.0f, 1.0f);
  EXPECT_NEAR(noon.sun.direction.y, -0.8660254f, 1e-4f);
  EXPECT_GT(noon.sky.zenith.b, noon.sky.zenith.r);
  EXPECT_LT(sunset.sun.irradiance.r, 0.25f * noon.sun.irradiance.r);
  EXPECT_GT(sunset.sun.irradiance.r, 1.8f * sunset.sun.irradiance.g);
  EXPECT_GT(sunset.sun.irradiance.g, 1.8f * sunset.sun.irradiance.b);
  EXPECT_FLOAT_EQ(noon.sun.angular_diameter, 0.0093f);
}

TEST(Daylight, AzimuthRunsFromZTowardsX) {
  const Environment at_z = daylight(0.5f, 0.0f), at_x = daylight(0.5f, 1.5707964f);
  EXPECT_LT(at_z.sun.direction.z, -0.8f);  // light travels away from the sun
  EXPECT_NEAR(at_z.sun.direction.x, 0.0f, 1e-5f);
  EXPECT_LT(at_x.sun.direction.x, -0.8f);
  EXPECT_NEAR(at_x.sun.direction.z, 0.0f, 1e-5f);
}

TEST(Daylight, ChangesSmoothlyAndGoesDark) {
  Environment before = daylight(-1.5f, 0.3f);
  for (float elevation = -1.5f; elevation <= 1.55f; elevation += 0.001f) {
    const Environment now = daylight(elevation, 0.3f);
    for (int c = 0; c < 3; ++c) {
      ASSERT_TRUE(std::isfinite(now.sun.irradiance[c]));
      ASSERT_GE(now.sun.irradiance[c], 0.0f);
      ASSERT_GE(now.sky.zenith[c], 0.0f);
      ASSERT_GE(now.sky.ground[c], 0.0f);
      ASSERT_LT(std::abs(now.sun.irradiance[c] - before.sun.irradiance[c]), 0.1f) << elevation;
      ASSERT_LT(std::abs(now.sky.zenith[c] - before.sky.zenith[c]), 0.02f) << elevation;
      ASSERT_LT(std::abs(now.sky.ground[c] - before.sky.ground[c]), 0.02f) << elevation;
    }
    before = now;
  }
  for (float elevation : {-1.5f, -0.5f, -0.1f, -0.006f}) {
    EXPECT_EQ(daylight(elevation, 0.3f).sun.irradiance, glm::vec3(0.0f)) << elevation;
  }
  const Environment night = daylight(-0.5f, 0.3f);
  EXPECT_LT(night.sky.zenith.b, 0.02f);
  EXPECT_GT(night.sky.zenith.b, night.sky.zenith.r);
}

}  // namespace
}  // namespace helio::scene
