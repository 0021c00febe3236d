#include "scene/scene.h"

#include "scene/vertex_frames.h"

namespace helio::scene {
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
  if (tangents.size() != positions.size()) tangents = tangentsFromUv(*this, uvs);
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
