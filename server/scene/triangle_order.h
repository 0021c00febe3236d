// The order of a mesh's triangles.
#pragma once

#include "scene/scene.h"

namespace helio::scene {

/// Orders each submesh's triangles so that every half of them, half of a half, and so on, lies together: by recursive
/// median splits along that axis which leaves the halves' boxes the least area. lavapipe builds its acceleration
/// structures by halving triangles in the order in which they are given, so this is the quality of its trees; other
/// devices read neighbours from the same cache lines. Deterministic.
void orderTriangles(Mesh& mesh);
/// The same for one range of `indices` into `positions`.
void orderTriangles(const std::vector<glm::vec3>& positions, std::vector<uint32_t>& indices, const Submesh& submesh);

}  // namespace helio::scene
