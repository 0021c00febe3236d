#include "lamps.h"

#include <cstring>

#include "effects/emitters.h"
#include "probe.h"
#include "shared/frame.h"

namespace helio::test {

glm::dvec3 LampTriangle::locate(const glm::dvec3& q) const {
  const glm::dvec3 a = p[1] - p[0], b = p[2] - p[0], r = q - p[0], n = glm::cross(a, b);
  const double squared = glm::dot(n, n);
  return {glm::dot(glm::cross(r, b), n) / squared, glm::dot(glm::cross(a, r), n) / squared,
          std::abs(glm::dot(r, n)) / std::sqrt(squared)};
}

Lamps::Lamps(scene::ScenePtr scene)
    : scene_(std::move(scene)),
      commands_(probe().device()),
      resources_(probe().device(), commands_, *scene_),
      instances_(probe().device(), *scene_, resources_.emitterPower(), effects::emitterWeight),
      emitters_(probe().device(), *scene_) {
  world::World world(scene_);
  instances_.apply(world.beginTick(0.0), [](uint32_t, int64_t) {});
  commands_.begin();
  instances_.upload(commands_);
  emitters_.upload(commands_, instances_);
  commands_.submit();
  (void)commands_.finish();

  shared::FrameConstants frame{};
  frame.instances = instances_.recordBuffer().address();
  frame.meshes = resources_.meshes();
  frame.geometries = resources_.geometries();
  frame.materials = resources_.materials();
  frame.emitter_triangles = resources_.emitterTriangles();
  emitters_.describe(frame);
  frame_ = gpu::Buffer(probe().device(),
                       {"frame constants", sizeof frame, gpu::MemoryCategory::transfer, gpu::Placement::upload});
  std::memcpy(frame_.mapped(), &frame, sizeof frame);
  findTriangles();
}

void Lamps::findTriangles() {
  for (uint32_t slot = 0; slot < instances_.records().size(); ++slot) {
    const shared::InstanceRecord& record = instances_.records()[slot];
    if (record.mesh == shared::kNoMesh) continue;
    const scene::Mesh& mesh = scene_->meshes[record.mesh];
    for (uint32_t g = 0; g < mesh.submeshes.size(); ++g) {
      const scene::Submesh& submesh = mesh.submeshes[g];
      if (scene_->materials[submesh.material].emission == glm::vec3(0.0f)) continue;
      for (uint32_t t = 0; t < submesh.index_count / 3; ++t) {
        LampTriangle triangle{slot, g, t, {}};
        for (int v = 0; v < 3; ++v) {
          const glm::dvec4 p(
              glm::dvec3(mesh.positions[mesh.indices[submesh.first_index + 3 * t + static_cast<uint32_t>(v)]]), 1.0);
          for (int row = 0; row < 3; ++row) triangle.p[v][row] = glm::dot(glm::dvec4(record.rows[row]), p);
        }
        if (triangle.area() > 0.0) triangles_.push_back(triangle);
      }
    }
  }
}

shared::ProbeConstants Lamps::constants() const {
  shared::ProbeConstants constants{};
  constants.frame = frame_.address();
  return constants;
}

std::vector<uint32_t> Lamps::slots() const {
  std::vector<uint32_t> result;
  for (uint32_t slot = 0; slot < instances_.records().size(); ++slot)
    if (instances_.records()[slot].emitter_weight > 0.0f) result.push_back(slot);
  return result;
}

}  // namespace helio::test
