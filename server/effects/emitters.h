// Emissive triangles as light sources: tables from which shaders choose one in proportion to its power
// (shaders/lib/emitters.glsl). Two levels: an instance among all, then a triangle among its mesh's; so an edit touches
// only the first.
#pragma once

#include <span>
#include <vector>

#include "scene/scene.h"
#include "shared/scene.h"

namespace helio::effects {

/// Walker's alias method: entry i is taken with probability `keep[i]`, else `alias[i]`. [Walker 1977; Vose 1991]
struct AliasTable {
  std::vector<uint32_t> alias;
  std::vector<float> keep;
};
/// Weights >= 0 with a positive sum.
AliasTable makeAliasTable(std::span<const float> weights);

/// A mesh's share of the triangle table.
struct MeshEmitters {
  uint32_t first = 0;
  uint32_t count = 0;
  float power = 0.0f;                     ///< sum of area * luminance of emission, object space
  std::vector<uint32_t> geometry_offset;  ///< by submesh: of its first triangle, or kNoTexture
};

/// The emissive triangles of all meshes of a scene.
struct EmitterTriangles {
  std::vector<shared::EmitterTriangle> triangles;
  std::vector<MeshEmitters> meshes;       ///< by mesh
  std::vector<shared::LampShape> shapes;  ///< by mesh
};
EmitterTriangles collectEmitters(const scene::Scene& scene);

/// Power of a mesh's emitters under a transform, for choosing among instances: object-space power times scale squared.
float emitterWeight(float mesh_power, const glm::mat4x3& transform);

}  // namespace helio::effects
