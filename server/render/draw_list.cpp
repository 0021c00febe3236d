#include "render/draw_list.h"

#include <array>
#include <cmath>

#include "render/camera_frame.h"

namespace helio::render {

DrawList cullToFrustum(const accel::InstanceTable& instances, size_t mesh_count, const scene::Camera& camera,
                       float aspect) {
  // Inward unit normals of the four sides.
  const CameraFrame frame = cameraFrame(camera);
  const float half_height = frame.tangent, half_width = frame.tangent * aspect;
  const auto side = [&](const glm::vec3& axis, float half) {
    return (frame.forward * half - axis) / std::sqrt(1.0f + half * half);
  };
  const std::array sides{side(frame.right, half_width), side(-frame.right, half_width), side(frame.up, half_height),
                         side(-frame.up, half_height)};

  std::vector<uint32_t> visible;
  std::vector<uint32_t> counts(mesh_count + 1);
  for (uint32_t slot : instances.order()) {
    const accel::PlacedInstance& instance = instances.instances()[slot];
    const glm::vec3 relative = instance.centre - camera.position;
    bool inside = true;
    for (const glm::vec3& normal : sides) inside = inside && glm::dot(normal, relative) > -instance.radius;
    if (!inside) continue;
    visible.push_back(slot);
    ++counts[instance.mesh + 1];
  }

  // Counting sort by mesh.
  DrawList list;
  for (size_t m = 0; m < mesh_count; ++m) {
    if (counts[m + 1]) list.draws.push_back({static_cast<uint32_t>(m), counts[m], counts[m + 1]});
    counts[m + 1] += counts[m];
  }
  list.slots.resize(visible.size());
  for (uint32_t slot : visible) list.slots[counts[instances.instances()[slot].mesh]++] = slot;
  return list;
}

}  // namespace helio::render
