// Alpha masks at import: which triangles a mask really cuts. [LiPaC thesis, §3.2.4]
#pragma once

#include <vector>

#include "scene/scene.h"

namespace helio::scene {

/// Least and greatest alpha, [0, 1], that bilinear reads of `texture` give within the triangle `uv`;
/// found by rasterising the triangle, and all texels that its reads touch, in the plane of the texture. Never too
/// narrow.
struct AlphaRange {
  float least = 1.0f;
  float greatest = 0.0f;
};
AlphaRange alphaWithin(const Texture& texture, const std::array<glm::vec2, 3>& uv);

/// Splits each submesh with a masked material in two: triangles that the mask leaves whole (`whole`: no ray need ask)
/// and those that it cuts holes into. Triangles of which it leaves nothing are dropped.
void splitCutOuts(Mesh& mesh, const std::vector<Material>& materials, const std::vector<Texture>& textures);

}  // namespace helio::scene
