#include "render/draw_list.h"

#include <algorithm>

#include "accel/strategy.h"
#include "render/camera_frame.h"

namespace helio::render {

DrawList cullToFrustum(const accel::InstanceTable& instances, size_t mesh_count, const scene::Camera& camera,
                       float aspect) {
  const CameraFrame frame = cameraFrame(camera);
  const shared::CullVolume frustum =
      accel::frustumOf(camera.position, frame.right, frame.up, frame.forward, frame.tangent, aspect);

  // Neighbours together first: the cost follows what is seen, not what there is.
  std::vector<uint32_t> visible;
  std::vector<uint32_t> counts(mesh_count + 1);
  const std::vector<uint32_t>& order = instances.order();
  for (size_t b = 0; b < instances.blocks().size(); ++b) {
    if (!accel::inFrustum(frustum, instances.blocks()[b].centre, instances.blocks()[b].radius)) continue;
    const size_t end = std::min(order.size(), (b + 1) * size_t{shared::kOrderBlock});
    for (size_t i = b * size_t{shared::kOrderBlock}; i < end; ++i) {
      const accel::PlacedInstance& instance = instances.instances()[order[i]];
      if (!accel::inFrustum(frustum, instance.centre, instance.radius)) continue;
      visible.push_back(order[i]);
      ++counts[instance.mesh + 1];
    }
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
