// The city's textures and materials, made once. Everything else names a material and never a colour.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace helio::scene {

/// Indices into `materials`. Arrays are shades of one texture: take any.
struct Palette {
  std::vector<Texture> textures;
  std::vector<Material> materials;
  std::vector<glm::vec2> metres;  ///< size of one texture repetition, one for each material

  // Walls and roofs
  std::array<uint32_t, 8> plaster{};
  std::array<uint32_t, 3> brick{};
  std::array<uint32_t, 3> timber_frame{};
  std::array<uint32_t, 2> ashlar{};
  std::array<uint32_t, 5> roof_tiles{};  // red, orange, brown, dark, old
  std::array<uint32_t, 2> slate{};
  std::array<uint32_t, 4> planks{};  // natural, dark, red, weathered
  std::array<uint32_t, 4> door{};
  std::array<uint32_t, 4> stripes{};
  std::array<uint32_t, 3> trim{};  // white, sandstone, dark
  uint32_t window = 0, lit_window = 0, copper = 0, iron = 0, gold = 0, mirror = 0, flat_roof = 0;
  // Ground
  std::array<uint32_t, 3> lawn{};
  std::array<uint32_t, 3> crops{};  // soil, green rows, wheat
  std::array<uint32_t, 3> meadow{};
  uint32_t asphalt = 0, cobbles = 0, slabs = 0, market = 0, gravel = 0, dirt = 0, courtyard = 0, forest_floor = 0;
  uint32_t kerb = 0, hill = 0, hill_woods = 0;
  // Nature
  std::array<uint32_t, 7> foliage{};  // oak, linden, birch, maple, apple, hedge, blossom
  std::array<uint32_t, 3> needles{};
  std::array<uint32_t, 2> bark{};  // brown, birch
  // People and vehicles
  std::array<uint32_t, 10> garment{};
  std::array<uint32_t, 4> complexion{};
  std::array<uint32_t, 4> hair{};
  std::array<uint32_t, 5> paint{};
  uint32_t leather = 0, tyre = 0, pane = 0;
  // Props
  uint32_t water = 0, lamp_light = 0, straw = 0, fruit_red = 0, fruit_orange = 0, cloth = 0, flowers = 0;
};

Palette makePalette();

}  // namespace helio::scene
