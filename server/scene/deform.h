// Shapes that change: a mesh in a pose of its rig.
#pragma once

#include <vector>

#include "scene/scene.h"

namespace helio::scene {

/// The mesh's vertices in the rig's space at a time within the clip: morph targets first, then the skin [glTF 2.0,
/// §3.7.2.2, §3.7.3.3]. What shaders/lib/deform.glsl does, for bounds and tests. Not for meshes fitted to the ground.
std::vector<glm::vec3> deformedPositions(const Mesh& mesh, const Rig& rig, const Clip& clip, float time);

/// Bounds of the mesh over all clips of the rig, with a margin for what lies between the times looked at.
Aabb boundsOverClips(const Mesh& mesh, const Rig& rig);

}  // namespace helio::scene
