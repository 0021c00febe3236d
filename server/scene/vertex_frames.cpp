#include "scene/vertex_frames.h"

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

float cross(const glm::vec2& a, const glm::vec2& b) { return a.x * b.y - a.y * b.x; }

}  // namespace

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

std::vector<glm::vec4> tangentsFromUv(const Mesh& mesh, std::span<const glm::vec2> uvs) {
  std::vector<glm::vec3> along_u(mesh.positions.size(), glm::vec3(0.0f));
  std::vector<glm::vec3> against_v(mesh.positions.size(), glm::vec3(0.0f));
  for (size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    const uint32_t a = mesh.indices[i], b = mesh.indices[i + 1], c = mesh.indices[i + 2];
    const glm::vec3 e1 = mesh.positions[b] - mesh.positions[a], e2 = mesh.positions[c] - mesh.positions[a];
    const glm::vec2 d1 = uvs[b] - uvs[a], d2 = uvs[c] - uvs[a];
    const float determinant = cross(d1, d2);
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

void splitMirroredSeams(Mesh& mesh, std::span<const glm::vec2> uvs) {
  // The uvs as they were: `uvs` may be one of the arrays that grow.
  const std::vector<glm::vec2> at(uvs.begin(), uvs.end());
  std::vector<int> side(at.size(), 0);
  std::vector<uint32_t> twin(at.size(), kNone);
  const auto copyOf = [&mesh](uint32_t v) {
    const auto repeat = [v](auto& array) {
      if (!array.empty()) array.push_back(array[v]);
    };
    repeat(mesh.positions);
    repeat(mesh.normals);
    repeat(mesh.uvs);
    for (std::vector<glm::vec2>& channel : mesh.more_uvs) repeat(channel);
    repeat(mesh.colors);
    repeat(mesh.skin);
    for (MorphTarget& target : mesh.morph_targets) {
      repeat(target.positions);
      repeat(target.normals);
    }
    return static_cast<uint32_t>(mesh.positions.size() - 1);
  };
  for (size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    uint32_t* corners = &mesh.indices[i];
    const float area = cross(at[corners[1]] - at[corners[0]], at[corners[2]] - at[corners[0]]);
    if (area == 0.0f || !std::isfinite(area)) continue;
    const int triangle_side = area > 0.0f ? 1 : -1;
    for (size_t k = 0; k < 3; ++k) {
      const uint32_t v = corners[k];
      if (side[v] == 0) side[v] = triangle_side;
      if (side[v] == triangle_side) continue;
      if (twin[v] == kNone) twin[v] = copyOf(v);
      corners[k] = twin[v];
    }
  }
}

}  // namespace helio::scene
