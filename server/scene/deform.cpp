#include "scene/deform.h"

#include <algorithm>

namespace helio::scene {

std::vector<glm::vec3> deformedPositions(const Mesh& mesh, const Rig& rig, const Clip& clip, float time) {
  const std::vector<glm::mat4x3> joints = jointsAt(rig, clip, time);
  const std::vector<float> weights = weightsAt(rig, clip, time);
  std::vector<glm::vec3> positions = mesh.positions;
  for (size_t t = 0; t < std::min(weights.size(), mesh.morph_targets.size()); ++t)
    for (size_t v = 0; v < positions.size(); ++v) positions[v] += weights[t] * mesh.morph_targets[t].positions[v];
  for (size_t v = 0; v < mesh.skin.size(); ++v) {
    const VertexSkin& skin = mesh.skin[v];
    glm::vec3 p(0.0f);
    for (int k = 0; k < 4; ++k)
      if (skin.weights[k] > 0.0f) p += skin.weights[k] * (joints[skin.joints[k]] * glm::vec4(positions[v], 1.0f));
    positions[v] = p;
  }
  return positions;
}

Aabb boundsOverClips(const Mesh& mesh, const Rig& rig) {
  constexpr int kTimes = 24;  // a clip
  constexpr float kMargin = 0.05f;
  Aabb bounds;
  for (const Clip& clip : rig.clips) {
    const int times = clip.duration > 0.0f ? kTimes : 1;
    for (int i = 0; i < times; ++i) {
      const float time = clip.duration * static_cast<float>(i) / static_cast<float>(kTimes);
      for (const glm::vec3& p : deformedPositions(mesh, rig, clip, time)) bounds.grow(p);
    }
  }
  if (bounds.empty()) return bounds;
  const glm::vec3 margin = kMargin * bounds.extent();
  return {bounds.min - margin, bounds.max + margin};
}

}  // namespace helio::scene
