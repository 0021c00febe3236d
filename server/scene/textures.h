// Procedural, tileable textures. A pattern says colour and height of a point; from it come a base colour texture and a
// normal map. Colours are written sRGB-encoded, as painters think of them.
#pragma once

#include <functional>
#include <string>

#include "scene/scene.h"

namespace helio::scene {

struct Texel {
  glm::vec3 color{0.0f};   ///< sRGB-encoded, [0, 1]
  float height = 0.0f;     ///< metres above the surface
  float roughness = 1.0f;  ///< only for metallic-roughness textures
};

/// u runs right and v down, both in [0, 1); patterns repeat beyond.
using Pattern = std::function<Texel(float u, float v)>;

/// A surface's pattern with the size of one repetition in metres (across, down).
struct SurfacePattern {
  std::string name;
  uint32_t size = 256;  ///< texels along each side
  glm::vec2 metres{1.0f};
  Pattern texel;
};

Texture paintBaseColor(const SurfacePattern& surface);
/// Linear, +y up the image (glTF).
Texture paintNormals(const SurfacePattern& surface);
/// Linear, roughness in green, metallic (0) in blue.
Texture paintRoughness(const SurfacePattern& surface);

namespace patterns {

SurfacePattern plaster();
SurfacePattern brick();
SurfacePattern timberFrame();
SurfacePattern ashlar();
SurfacePattern roofTiles();
SurfacePattern slate();
SurfacePattern planks();
SurfacePattern cobbles();
SurfacePattern slabs();
SurfacePattern asphalt();
SurfacePattern gravel();
SurfacePattern grass();
SurfacePattern forestFloor();
SurfacePattern soilRows();
SurfacePattern cropRows();
SurfacePattern wheat();
SurfacePattern window();
SurfacePattern litWindow();
SurfacePattern door();
SurfacePattern bark();
SurfacePattern foliage();
SurfacePattern needles();
SurfacePattern canopy();
SurfacePattern stripes();

}  // namespace patterns
}  // namespace helio::scene
