#include "city_probe.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace helio::scene {
namespace {

constexpr double kProbeCell = 64.0;

struct Fnv {
  uint64_t state = 14695981039346656037u;
  void bytes(const void* data, size_t size) {
    const auto* p = static_cast<const unsigned char*>(data);
    for (size_t i = 0; i < size; ++i) state = (state ^ p[i]) * 1099511628211u;
  }
  template <typename T>
  void all(const std::vector<T>& items) {
    bytes(items.data(), items.size() * sizeof(T));
  }
  template <typename T>
  void one(const T& item) {
    bytes(&item, sizeof(T));
  }
  void text(const std::string& s) { bytes(s.data(), s.size()); }
};

}  // namespace

uint64_t hashScene(const Scene& scene) {
  Fnv fnv;
  fnv.text(scene.name);
  for (const Texture& t : scene.textures) {
    fnv.text(t.name);
    fnv.all(t.rgba);
  }
  for (const Material& m : scene.materials) {
    fnv.text(m.name);
    fnv.one(m.base_color);
    fnv.one(m.emission);
    fnv.one(m.roughness);
    fnv.one(m.metallic);
    fnv.one(m.base_color_texture);
    fnv.one(m.normal_texture);
  }
  for (const Mesh& m : scene.meshes) {
    fnv.text(m.name);
    fnv.all(m.positions);
    fnv.all(m.normals);
    fnv.all(m.tangents);
    fnv.all(m.uvs);
    fnv.all(m.indices);
    for (const Submesh& s : m.submeshes) {
      fnv.one(s.first_index);
      fnv.one(s.index_count);
      fnv.one(s.material);
      fnv.one(s.whole);
    }
  }
  for (const Prefab& p : scene.prefabs) {
    fnv.text(p.name + "/" + p.category);
    fnv.one(p.mesh);
    fnv.one(p.buildable);
  }
  fnv.all(scene.placements);
  fnv.one(scene.environment);
  for (const NamedCamera& c : scene.cameras) {
    fnv.text(c.name + "/" + c.description);
    fnv.one(c.camera);
    fnv.one(c.environment);
  }
  return fnv.state;
}

const Scene& cityOf(uint64_t seed, uint32_t instances) {
  static std::map<std::pair<uint64_t, uint32_t>, ScenePtr> cities;
  ScenePtr& city = cities[{seed, instances}];
  if (!city) {
    Result<ScenePtr> result = generateCity({seed, instances});
    if (!result) throw std::runtime_error(result.error().message);
    city = *result;
  }
  return *city;
}

Rectangle footprintOf(const Scene& scene, const Placement& placement) {
  const Aabb& box = scene.meshes[scene.prefabs[placement.prefab].mesh].bounds;
  const glm::dvec3 x(placement.transform[0]), centre(placement.transform * glm::vec4(box.centre(), 1.0f));
  const double scale = glm::length(x);
  const glm::dvec3 half(0.5f * box.extent());
  return {{centre.x, centre.z}, glm::dvec2(x.x, x.z) / scale, glm::dvec2(half.x, half.z) * scale};
}

GroundProbe::GroundProbe(const Scene& scene) {
  for (const Placement& placement : scene.placements) {
    if (scene.prefabs[placement.prefab].category != "terrain") continue;
    const Mesh& mesh = scene.meshes[scene.prefabs[placement.prefab].mesh];
    const Tile tile{&mesh, placement.transform, transform(mesh.bounds, placement.transform)};
    const auto cell = [](float v) { return static_cast<int64_t>(std::floor(v / kProbeCell)); };
    for (int64_t z = cell(tile.box.min.z); z <= cell(tile.box.max.z); ++z) {
      for (int64_t x = cell(tile.box.min.x); x <= cell(tile.box.max.x); ++x) tiles_[key(x, z)].push_back(tile);
    }
  }
}

float GroundProbe::height(glm::dvec2 p) const {
  double highest = -std::numeric_limits<double>::infinity();
  const auto found = tiles_.find(
      key(static_cast<int64_t>(std::floor(p.x / kProbeCell)), static_cast<int64_t>(std::floor(p.y / kProbeCell))));
  if (found == tiles_.end()) return static_cast<float>(highest);
  for (const Tile& tile : found->second) {
    const auto corner = [&](size_t i) {
      return glm::dvec3(tile.transform * glm::vec4(tile.mesh->positions[tile.mesh->indices[i]], 1.0f));
    };
    for (size_t i = 0; i < tile.mesh->indices.size(); i += 3) {
      const glm::dvec3 a = corner(i), b = corner(i + 1), c = corner(i + 2);
      const glm::dvec2 u(b.x - a.x, b.z - a.z), v(c.x - a.x, c.z - a.z), q(p.x - a.x, p.y - a.z);
      const double determinant = u.x * v.y - u.y * v.x;
      if (std::abs(determinant) < 1e-9) continue;  // upright
      const double s = (q.x * v.y - q.y * v.x) / determinant, t = (u.x * q.y - u.y * q.x) / determinant;
      constexpr double kSlack = 1e-6;
      if (s < -kSlack || t < -kSlack || s + t > 1.0 + kSlack) continue;
      highest = std::max(highest, a.y + s * (b.y - a.y) + t * (c.y - a.y));
    }
  }
  return static_cast<float>(highest);
}

}  // namespace helio::scene
