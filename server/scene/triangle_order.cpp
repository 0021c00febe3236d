#include "scene/triangle_order.h"

#include <algorithm>
#include <numeric>
#include <span>

namespace helio::scene {
namespace {

float halfArea(const Aabb& box) {
  const glm::vec3 e = box.extent();
  return e.x * e.y + e.y * e.z + e.z * e.x;
}

class Sorter {
 public:
  Sorter(const std::vector<glm::vec3>& positions, std::span<const uint32_t> indices)
      : boxes_(indices.size() / 3), order_(boxes_.size()) {
    for (size_t t = 0; t < boxes_.size(); ++t)
      for (size_t k = 0; k < 3; ++k) boxes_[t].grow(positions[indices[3 * t + k]]);
    std::iota(order_.begin(), order_.end(), 0u);
  }

  const std::vector<uint32_t>& sort() {
    split(order_);
    return order_;
  }

 private:
  void split(std::span<uint32_t> range) {
    if (range.size() < 3) return;
    const size_t half = (range.size() + 1) / 2;  // the larger half comes first, as lavapipe has it
    int best = 0;
    float least = std::numeric_limits<float>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
      partition(range, half, axis);
      const float cost = halfArea(boundsOf(range.first(half))) * static_cast<float>(half) +
                         halfArea(boundsOf(range.subspan(half))) * static_cast<float>(range.size() - half);
      if (cost < least) {
        least = cost;
        best = axis;
      }
    }
    if (best != 2) partition(range, half, best);
    split(range.first(half));
    split(range.subspan(half));
  }

  /// The `half` triangles that lie lowest along the axis first.
  void partition(std::span<uint32_t> range, size_t half, int axis) const {
    std::nth_element(range.begin(), range.begin() + static_cast<std::ptrdiff_t>(half), range.end(),
                     [&](uint32_t a, uint32_t b) {
                       const float ca = boxes_[a].min[axis] + boxes_[a].max[axis];
                       const float cb = boxes_[b].min[axis] + boxes_[b].max[axis];
                       return ca != cb ? ca < cb : a < b;
                     });
  }

  Aabb boundsOf(std::span<const uint32_t> range) const {
    Aabb box;
    for (const uint32_t t : range) box.grow(boxes_[t]);
    return box;
  }

  std::vector<Aabb> boxes_;
  std::vector<uint32_t> order_;
};

}  // namespace

void orderTriangles(const std::vector<glm::vec3>& positions, std::vector<uint32_t>& indices, const Submesh& submesh) {
  const std::span<uint32_t> range = std::span(indices).subspan(submesh.first_index, submesh.index_count);
  const std::vector<uint32_t> before(range.begin(), range.end());
  auto to = range.begin();
  Sorter sorter(positions, before);
  for (const uint32_t t : sorter.sort())
    to = std::copy_n(before.begin() + static_cast<std::ptrdiff_t>(size_t{3} * t), 3, to);
}

void orderTriangles(Mesh& mesh) {
  for (const Submesh& submesh : mesh.submeshes) orderTriangles(mesh.positions, mesh.indices, submesh);
}

}  // namespace helio::scene
