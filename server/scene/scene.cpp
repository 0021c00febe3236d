#include "scene/scene.h"

#include <cmath>

namespace helio::scene {
namespace {

constexpr float kTinyLengthSquared = 1e-24f;

/// A unit vector perpendicular to the unit vector `n`. [Duff et al. 2017]
glm::vec3 perpendicular(const glm::vec3& n) {
  const float sign = std::copysign(1.0f, n.z);
  const float a = -1.0f / (sign + n.z);
  return {1.0f + sign * n.x * n.x * a, sign * n.x * n.y * a, -sign * n.x};
}

bool hasDirection(const glm::vec3& v) {
  const float length_squared = glm::dot(v, v);
  return length_squared > kTinyLengthSquared && std::isfinite(length_squared);
}

std::vector<glm::vec3> areaWeightedNormals(const Mesh& mesh) {
  std::vector<glm::vec3> sums(mesh.positions.size(), glm::vec3(0.0f));
  for (size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    const uint32_t a = mesh.indices[i], b = mesh.indices[i + 1], c = mesh.indices[i + 2];
    const glm::vec3 doubled_area =
        glm::cross(mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a]);
    for (uint32_t v : {a, b, c}) sums[v] += doubled_area;
  }
  for (glm::vec3& n : sums) n = hasDirection(n) ? glm::normalize(n) : glm::vec3(0.0f, 1.0f, 0.0f);
  return sums;
}

/// Tangents along increasing u. glTF's v runs down the image while the normal map's y runs up it, so the bitangent
/// cross(n, t) * w points against increasing v.
std::vector<glm::vec4> tangentsFromUv(const Mesh& mesh) {
  std::vector<glm::vec3> along_u(mesh.positions.size(), glm::vec3(0.0f));
  std::vector<glm::vec3> against_v(mesh.positions.size(), glm::vec3(0.0f));
  for (size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    const uint32_t a = mesh.indices[i], b = mesh.indices[i + 1], c = mesh.indices[i + 2];
    const glm::vec3 e1 = mesh.positions[b] - mesh.positions[a], e2 = mesh.positions[c] - mesh.positions[a];
    const glm::vec2 d1 = mesh.uvs[b] - mesh.uvs[a], d2 = mesh.uvs[c] - mesh.uvs[a];
    const float determinant = d1.x * d2.y - d1.y * d2.x;
    if (determinant == 0.0f || !std::isfinite(determinant)) continue;
    // Weighted by the area in uv and turned the right way round: no division by a small determinant.
    const float side = std::copysign(1.0f, determinant);
    const glm::vec3 du = side * (e1 * d2.y - e2 * d1.y), dv = side * (e2 * d1.x - e1 * d2.x);
    for (uint32_t v : {a, b, c}) {
      along_u[v] += du;
      against_v[v] -= dv;
    }
  }
  std::vector<glm::vec4> tangents(mesh.positions.size());
  for (size_t v = 0; v < tangents.size(); ++v) {
    const glm::vec3 n = mesh.normals[v];
    const glm::vec3 projected = along_u[v] - n * glm::dot(n, along_u[v]);
    const glm::vec3 t = hasDirection(projected) ? glm::normalize(projected) : perpendicular(n);
    tangents[v] = glm::vec4(t, glm::dot(glm::cross(n, t), against_v[v]) < 0.0f ? -1.0f : 1.0f);
  }
  return tangents;
}

}  // namespace

Aabb transform(const Aabb& box, const glm::mat4x3& m) {
  if (box.empty()) return box;
  Aabb result{m[3], m[3]};
  for (int axis = 0; axis < 3; ++axis) {
    const glm::vec3 low = m[axis] * box.min[axis], high = m[axis] * box.max[axis];
    result.min += glm::min(low, high);
    result.max += glm::max(low, high);
  }
  return result;
}

void Mesh::finish() {
  if (normals.size() != positions.size()) normals = areaWeightedNormals(*this);
  if (uvs.size() != positions.size()) uvs.assign(positions.size(), glm::vec2(0.0f));
  if (tangents.size() != positions.size()) tangents = tangentsFromUv(*this);
  bounds = {};
  for (const glm::vec3& p : positions) bounds.grow(p);
}

Aabb Scene::bounds() const {
  Aabb result;
  for (const Placement& placement : placements) {
    result.grow(transform(meshes[prefabs[placement.prefab].mesh].bounds, placement.transform));
  }
  return result;
}

uint32_t Scene::findPrefab(const std::string& prefab_name) const {
  for (size_t i = 0; i < prefabs.size(); ++i) {
    if (prefabs[i].name == prefab_name) return static_cast<uint32_t>(i);
  }
  return kNone;
}

}  // namespace helio::scene
