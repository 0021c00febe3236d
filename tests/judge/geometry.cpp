#include "judge/geometry.h"

#include <algorithm>
#include <array>

namespace helio::judge {
namespace {

constexpr uint32_t kLeaf = 4;

glm::dvec3 centre(const Triangle& t) { return (t.p[0] + t.p[1] + t.p[2]) / 3.0; }

/// Moeller and Trumbore's test.
void intersect(const Triangle& t, uint32_t index, const Ray& ray, double least, Intersection& best) {
  const glm::dvec3 a = t.p[1] - t.p[0], b = t.p[2] - t.p[0], q = glm::cross(ray.direction, b);
  const double determinant = glm::dot(a, q);
  if (determinant == 0.0) return;
  const glm::dvec3 s = ray.origin - t.p[0], r = glm::cross(s, a);
  const double u = glm::dot(s, q) / determinant, v = glm::dot(ray.direction, r) / determinant;
  const double distance = glm::dot(b, r) / determinant;
  if (u < 0.0 || v < 0.0 || u + v > 1.0 || distance <= least || distance >= best.t) return;
  best = {distance, index, u, v};
}

}  // namespace

Geometry::Geometry(const scene::Scene& scene) {
  for (const scene::Placement& placement : scene.placements) {
    const scene::Mesh& mesh = scene.meshes[scene.prefabs[placement.prefab].mesh];
    const glm::dmat4x3 transform(placement.transform);
    const glm::dmat3 normal_transform = glm::inverse(glm::transpose(glm::dmat3(transform)));
    for (const scene::Submesh& submesh : mesh.submeshes)
      for (uint32_t i = 0; i + 2 < submesh.index_count; i += 3) {
        Triangle t{{}, {}, submesh.material};
        for (uint32_t v = 0; v < 3; ++v) {
          const uint32_t vertex = mesh.indices[submesh.first_index + i + v];
          t.p[v] = transform * glm::dvec4(glm::dvec3(mesh.positions[vertex]), 1.0);
          t.normal[v] = glm::normalize(normal_transform * glm::dvec3(mesh.normals[vertex]));
        }
        triangles_.push_back(t);
      }
  }
  nodes_.emplace_back();
  split(0, 0, static_cast<uint32_t>(triangles_.size()));
}

void Geometry::split(uint32_t node, uint32_t first, uint32_t count) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Node made{glm::dvec3(kInfinity), glm::dvec3(-kInfinity), first, count};
  for (uint32_t i = first; i < first + count; ++i)
    for (const glm::dvec3& p : triangles_[i].p) {
      made.low = glm::min(made.low, p);
      made.high = glm::max(made.high, p);
    }
  if (count > kLeaf) {
    const glm::dvec3 extent = made.high - made.low;
    const int axis = extent.x > extent.y && extent.x > extent.z ? 0 : extent.y > extent.z ? 1 : 2;
    const auto begin = triangles_.begin() + first;
    std::nth_element(begin, begin + count / 2, begin + count,
                     [&](const Triangle& a, const Triangle& b) { return centre(a)[axis] < centre(b)[axis]; });
    const auto children = static_cast<uint32_t>(nodes_.size());
    made.first = children;
    made.count = 0;
    nodes_.resize(nodes_.size() + 2);
    split(children, first, count / 2);
    split(children + 1, first + count / 2, count - count / 2);
  }
  nodes_[node] = made;
}

std::optional<Intersection> Geometry::intersect(const Ray& ray, double least) const {
  Intersection best;
  const glm::dvec3 inverse = 1.0 / ray.direction;
  std::array<uint32_t, 64> stack{};
  size_t depth = 1;  // the root is on it
  while (depth > 0) {
    const Node& node = nodes_[stack[--depth]];
    const glm::dvec3 a = (node.low - ray.origin) * inverse, b = (node.high - ray.origin) * inverse;
    const glm::dvec3 near3 = glm::min(a, b), far3 = glm::max(a, b);
    // Written so that a NaN, from a ray within a face of the box, counts as a hit.
    const double enter = std::max({near3.x, near3.y, near3.z}), leave = std::min({far3.x, far3.y, far3.z});
    if (enter > leave * (1.0 + 1e-12) || leave < 0.0 || enter > best.t) continue;
    for (uint32_t i = node.first; i < node.first + node.count; ++i)
      judge::intersect(triangles_[i], i, ray, least, best);
    if (node.count == 0 && depth + 2 <= stack.size()) {
      stack[depth++] = node.first;
      stack[depth++] = node.first + 1;
    }
  }
  if (best.t == std::numeric_limits<double>::infinity()) return std::nullopt;
  return best;
}

}  // namespace helio::judge
