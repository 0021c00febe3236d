// Normals and tangents for meshes that come without.
#pragma once

#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "scene/scene.h"

namespace helio::scene {

/// One unit normal a vertex: the mean of its triangles', weighted by area.
std::vector<glm::vec3> areaWeightedNormals(const Mesh& mesh);

/// One tangent a vertex, unit, along increasing u of `uvs` (one a vertex); w is the handedness. glTF's v runs down the
/// image while the normal map's y runs up it, so the bitangent cross(n, t) * w points against increasing v.
std::vector<glm::vec4> tangentsFromUv(const Mesh& mesh, std::span<const glm::vec2> uvs);

/// Where triangles with mirrored texture coordinates meet others, their shared vertices get a twin: each side needs a
/// tangent of its own, and the mean of both has no direction. For meshes without tangents; `uvs` holds one a vertex and
/// may be an array of the mesh.
void splitMirroredSeams(Mesh& mesh, std::span<const glm::vec2> uvs);

}  // namespace helio::scene
