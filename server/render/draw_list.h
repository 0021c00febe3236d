// What the rasteriser draws for a camera: the instances in its frustum, gathered by mesh.
#pragma once

#include <vector>

#include "accel/instance_table.h"
#include "scene/scene.h"

namespace helio::render {

/// `count` instances of `mesh`: their slots are DrawList::slots[first .. first + count).
struct MeshDraw {
  uint32_t mesh;
  uint32_t first;
  uint32_t count;
};

struct DrawList {
  std::vector<uint32_t> slots;
  std::vector<MeshDraw> draws;  ///< ascending by mesh: the order, and so the picture, is the same every time
};

/// Bounding spheres against the frustum's four sides (the far plane is at infinity).
DrawList cullToFrustum(const accel::InstanceTable& instances, size_t mesh_count, const scene::Camera& camera,
                       float aspect);

}  // namespace helio::render
