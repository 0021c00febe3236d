#include "scene/textures.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "scene/random.h"

namespace helio::scene {
namespace {

uint8_t toByte(float value) { return static_cast<uint8_t>(std::clamp(value, 0.0f, 1.0f) * 255.0f + 0.5f); }

Texture emptyTexture(const std::string& name, uint32_t size, bool srgb) {
  Texture texture;
  texture.name = name;
  texture.width = texture.height = size;
  texture.srgb = srgb;
  texture.rgba.assign(size_t{size} * size * 4, 255);
  return texture;
}

/// Calls write(texel, bytes) for every texel of a square texture.
template <typename Write>
Texture paint(const std::string& name, const SurfacePattern& surface, bool srgb, Write write) {
  Texture texture = emptyTexture(name, surface.size, srgb);
  const float step = 1.0f / static_cast<float>(surface.size);
  for (uint32_t y = 0; y < surface.size; ++y) {
    for (uint32_t x = 0; x < surface.size; ++x) {
      const float u = (static_cast<float>(x) + 0.5f) * step, v = (static_cast<float>(y) + 0.5f) * step;
      write(surface.texel(u, v), &texture.rgba[(size_t{y} * surface.size + x) * 4]);
    }
  }
  return texture;
}

}  // namespace

Texture paintBaseColor(const SurfacePattern& surface) {
  return paint(surface.name, surface, true, [](const Texel& texel, uint8_t* rgba) {
    for (int c = 0; c < 3; ++c) rgba[c] = toByte(texel.color[c]);
  });
}

Texture paintRoughness(const SurfacePattern& surface) {
  return paint(surface.name + "_roughness", surface, false, [](const Texel& texel, uint8_t* rgba) {
    rgba[0] = 0;
    rgba[1] = toByte(texel.roughness);
    rgba[2] = 0;
  });
}

Texture paintNormals(const SurfacePattern& surface) {
  const uint32_t size = surface.size;
  std::vector<float> heights(size_t{size} * size);
  const float step = 1.0f / static_cast<float>(size);
  for (uint32_t y = 0; y < size; ++y) {
    for (uint32_t x = 0; x < size; ++x) {
      heights[size_t{y} * size + x] =
          surface.texel((static_cast<float>(x) + 0.5f) * step, (static_cast<float>(y) + 0.5f) * step).height;
    }
  }
  const auto height = [&](uint32_t x, uint32_t y) { return heights[size_t{y % size} * size + x % size]; };
  Texture texture = emptyTexture(surface.name + "_normal", size, false);
  const glm::vec2 slope_scale = static_cast<float>(size) / (2.0f * surface.metres);
  for (uint32_t y = 0; y < size; ++y) {
    for (uint32_t x = 0; x < size; ++x) {
      const float right = (height(x + 1, y) - height(x + size - 1, y)) * slope_scale.x;
      const float up = (height(x, y + size - 1) - height(x, y + 1)) * slope_scale.y;
      const glm::vec3 n = glm::normalize(glm::vec3(-right, -up, 1.0f));
      uint8_t* rgba = &texture.rgba[(size_t{y} * size + x) * 4];
      for (int c = 0; c < 3; ++c) rgba[c] = toByte(0.5f + 0.5f * n[c]);
    }
  }
  return texture;
}
}  // namespace helio::scene
