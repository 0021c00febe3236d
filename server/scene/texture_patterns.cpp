#include <algorithm>
#include <cmath>

#include "scene/random.h"
#include "scene/textures.h"

namespace helio::scene::patterns {
namespace {

using glm::mix;
using glm::smoothstep;
using glm::vec2;
using glm::vec3;

float fract(float x) { return x - std::floor(x); }

/// Tileable noise in [-1, 1] with `cells` features along each side.
float noise(uint64_t seed, float u, float v, int64_t cells, int octaves = 3) {
  return fractalNoise(seed, u * static_cast<float>(cells), v * static_cast<float>(cells), octaves, cells);
}

/// Where a point lies in rows of bricks (every other row shifted by half a brick).
struct Masonry {
  vec2 local;  ///< [0, 1) across and down the unit
  float edge;  ///< metres to the nearest joint
  float tint;  ///< [0, 1), one for each unit
};

Masonry masonry(uint64_t seed, float u, float v, int columns, int rows, vec2 metres, float jitter = 0.0f) {
  const float row = std::floor(v * static_cast<float>(rows));
  const float shift = 0.5f * static_cast<float>(static_cast<int>(row) & 1) +
                      jitter * unitFloat(hash64(seed, static_cast<int64_t>(row), 77));
  const float across = fract(u + shift / static_cast<float>(columns)) * static_cast<float>(columns);
  const vec2 local{fract(across), fract(v * static_cast<float>(rows))};
  const vec2 unit = metres / vec2(columns, rows);
  const vec2 to_edge = (0.5f - glm::abs(local - 0.5f)) * unit;
  const auto column = static_cast<int64_t>(std::floor(across));
  return {local, std::min(to_edge.x, to_edge.y), unitFloat(hash64(seed, column, static_cast<int64_t>(row)))};
}

/// The nearest and second nearest of jittered points, one in each of cells x cells squares.
struct Cellular {
  float nearest;  ///< in cells
  float border;   ///< second minus nearest: 0 on the border between two
  float tint;     ///< [0, 1), one for each point
};

Cellular cellular(uint64_t seed, float u, float v, int cells, float jitter = 0.8f) {
  const vec2 p = vec2(u, v) * static_cast<float>(cells);
  const auto px = static_cast<int>(std::floor(p.x)), py = static_cast<int>(std::floor(p.y));
  float first = 1e9f, second = 1e9f, tint = 0.0f;
  for (int y = py - 1; y <= py + 1; ++y) {
    for (int x = px - 1; x <= px + 1; ++x) {
      const uint64_t h = hash64(seed, (x + cells) % cells, (y + cells) % cells);
      const vec2 offset{unitFloat(h), unitFloat(hash64(h))};
      const vec2 q = vec2(x, y) + 0.5f + jitter * (offset - 0.5f);
      const float d = glm::distance(p, q);
      if (d < first) {
        second = first;
        first = d;
        tint = unitFloat(hash64(h, 3));
      } else {
        second = std::min(second, d);
      }
    }
  }
  return {first, second - first, tint};
}

}  // namespace

SurfacePattern plaster() {
  return {"plaster", 256, vec2(4.0f), [](float u, float v) {
            const float cloud = noise(11, u, v, 4, 4), grain = noise(12, u, v, 48, 2);
            return Texel{vec3(0.93f + 0.035f * cloud + 0.02f * grain) * vec3(1.0f, 0.995f, 0.985f), 0.004f * grain};
          }};
}

SurfacePattern brick() {
  return {"brick", 256, vec2(1.92f, 1.92f), [](float u, float v) {
            const Masonry m = masonry(21, u, v, 8, 24, vec2(1.92f));
            const float joint = 1.0f - smoothstep(0.004f, 0.011f, m.edge);
            const vec3 body = mix(vec3(0.58f, 0.30f, 0.22f), vec3(0.72f, 0.43f, 0.31f), m.tint) *
                              (1.0f + 0.10f * noise(22, u, v, 32));
            return Texel{mix(body, vec3(0.70f, 0.66f, 0.60f), joint), -0.010f * joint};
          }};
}

SurfacePattern timberFrame() {
  // One bay of 2.5 m by one storey of 3 m: sill and head beam, posts, two braces, infill of plaster.
  return {"timber_frame", 256, vec2(2.5f, 3.0f), [](float u, float v) {
            const vec2 p{u * 2.5f, v * 3.0f};
            const float post = std::min(p.x, 2.5f - p.x) - 0.10f;
            const float beam = std::min(p.y, 3.0f - p.y) - 0.13f;
            const float rail = std::abs(p.y - 2.15f) - 0.07f;
            const float mirrored = std::min(p.x, 2.5f - p.x);
            const float brace = std::max(std::abs(0.88f * mirrored + 0.47f * (p.y - 3.0f)) - 0.08f, mirrored - 0.55f);
            const float d = std::min({post, beam, rail, brace});
            const float wood = 1.0f - smoothstep(-0.005f, 0.015f, d);
            const float grain = noise(31, u, v, 40, 2);
            const vec3 timber = vec3(0.30f, 0.20f, 0.13f) * (1.0f + 0.18f * grain);
            const vec3 infill = vec3(0.92f, 0.89f, 0.82f) * (1.0f + 0.03f * noise(32, u, v, 6, 4));
            return Texel{mix(infill, timber, wood), 0.02f * wood + 0.003f * grain};
          }};
}

SurfacePattern ashlar() {
  return {"ashlar", 256, vec2(2.4f), [](float u, float v) {
            const Masonry m = masonry(41, u, v, 4, 8, vec2(2.4f), 0.4f);
            const float joint = 1.0f - smoothstep(0.006f, 0.018f, m.edge);
            const float rough = noise(42, u, v, 24, 4);
            const vec3 body =
                mix(vec3(0.62f, 0.58f, 0.51f), vec3(0.74f, 0.70f, 0.62f), m.tint) * (1.0f + 0.07f * rough);
            return Texel{mix(body, vec3(0.46f, 0.44f, 0.40f), joint), 0.008f * rough - 0.02f * joint};
          }};
}

SurfacePattern roofTiles() {
  return {"roof_tiles", 256, vec2(2.0f), [](float u, float v) {
            const Masonry m = masonry(51, u, v, 8, 8, vec2(2.0f));
            // Each tile is an arch that overlaps the row below: high at its lower end, a shadow under it.
            const float arch = 1.0f - 4.0f * (m.local.x - 0.5f) * (m.local.x - 0.5f);
            const float overlap = m.local.y;
            const float under = smoothstep(0.0f, 0.16f, m.local.y);
            const vec3 clay = mix(vec3(0.52f, 0.27f, 0.19f), vec3(0.70f, 0.43f, 0.32f), m.tint);
            const float weather = 1.0f + 0.16f * noise(52, u, v, 3, 4);
            return Texel{clay * weather * mix(0.55f, 1.0f, under) * mix(0.82f, 1.0f, arch),
                         0.035f * arch + 0.03f * overlap};
          }};
}

SurfacePattern slate() {
  return {"slate", 256, vec2(2.0f), [](float u, float v) {
            const Masonry m = masonry(61, u, v, 7, 10, vec2(2.0f));
            const float joint = 1.0f - smoothstep(0.003f, 0.010f, m.edge);
            const vec3 stone = mix(vec3(0.28f, 0.30f, 0.34f), vec3(0.40f, 0.42f, 0.46f), m.tint);
            const float weather = 1.0f + 0.10f * noise(62, u, v, 8, 3);
            return Texel{stone * weather * mix(1.0f, 0.55f, joint), 0.015f * m.local.y - 0.01f * joint};
          }};
}

SurfacePattern planks() {
  return {"planks", 256, vec2(2.0f), [](float u, float v) {
            const float across = u * 10.0f, local = fract(across);
            const uint64_t board = hash64(71, static_cast<int64_t>(std::floor(across)), 0);
            const float joint = 1.0f - smoothstep(0.02f, 0.07f, 0.5f - std::abs(local - 0.5f));
            const float grain =
                fractalNoise(72, u * 80.0f, v * 6.0f + 6.0f * std::floor(6.0f * unitFloat(board)), 2, 0);
            const vec3 wood = mix(vec3(0.50f, 0.37f, 0.25f), vec3(0.62f, 0.48f, 0.34f), unitFloat(board));
            return Texel{wood * (1.0f + 0.10f * grain) * mix(1.0f, 0.45f, joint), -0.012f * joint + 0.002f * grain};
          }};
}

SurfacePattern cobbles() {
  return {"cobbles", 256, vec2(2.4f), [](float u, float v) {
            const Cellular c = cellular(81, u, v, 14, 0.55f);
            const float joint = 1.0f - smoothstep(0.05f, 0.22f, c.border);
            const vec3 stone = mix(vec3(0.50f, 0.48f, 0.46f), vec3(0.66f, 0.63f, 0.59f), c.tint);
            const float dirt = 1.0f + 0.08f * noise(82, u, v, 4, 4);
            return Texel{mix(stone, vec3(0.36f, 0.33f, 0.29f), joint) * dirt,
                         0.03f * std::sqrt(std::max(0.0f, 1.0f - c.nearest)) - 0.012f * joint};
          }};
}

SurfacePattern slabs() {
  return {"slabs", 256, vec2(3.2f), [](float u, float v) {
            const Masonry m = masonry(91, u, v, 4, 4, vec2(3.2f));
            const float joint = 1.0f - smoothstep(0.008f, 0.02f, m.edge);
            const float rough = noise(92, u, v, 16, 4);
            const vec3 stone =
                mix(vec3(0.64f, 0.61f, 0.55f), vec3(0.73f, 0.69f, 0.62f), m.tint) * (1.0f + 0.05f * rough);
            return Texel{mix(stone, vec3(0.42f, 0.40f, 0.36f), joint), 0.003f * rough - 0.01f * joint};
          }};
}

SurfacePattern asphalt() {
  return {"asphalt", 256, vec2(4.0f), [](float u, float v) {
            const float speck = noise(101, u, v, 96, 2), patch = noise(102, u, v, 4, 4);
            return Texel{vec3(0.36f, 0.36f, 0.37f) * (1.0f + 0.14f * speck + 0.10f * patch), 0.003f * speck};
          }};
}

SurfacePattern gravel() {
  return {"gravel", 256, vec2(4.0f), [](float u, float v) {
            const float speck = noise(111, u, v, 64, 3), patch = noise(112, u, v, 4, 4);
            return Texel{vec3(0.62f, 0.54f, 0.42f) * (1.0f + 0.12f * speck + 0.12f * patch), 0.008f * speck};
          }};
}

SurfacePattern grass() {
  return {"grass", 512, vec2(8.0f), [](float u, float v) {
            const float blades = noise(121, u, v, 128, 2), tufts = noise(122, u, v, 24, 3),
                        patch = noise(123, u, v, 4, 3);
            const vec3 green =
                mix(vec3(0.34f, 0.42f, 0.22f), vec3(0.50f, 0.53f, 0.31f), 0.5f + 0.45f * patch + 0.2f * tufts);
            return Texel{green * (1.0f + 0.20f * blades + 0.12f * tufts), 0.03f * blades + 0.03f * tufts};
          }};
}

SurfacePattern forestFloor() {
  return {"forest_floor", 256, vec2(8.0f), [](float u, float v) {
            const float litter = noise(131, u, v, 64, 3), moss = noise(132, u, v, 6, 4);
            const vec3 ground =
                mix(vec3(0.28f, 0.23f, 0.16f), vec3(0.27f, 0.31f, 0.17f), smoothstep(-0.5f, 0.3f, moss));
            return Texel{ground * (1.0f + 0.25f * litter), 0.03f * litter};
          }};
}

SurfacePattern soilRows() {
  return {"soil_rows", 256, vec2(4.0f), [](float u, float v) {
            const float furrow = 0.5f + 0.5f * (1.0f - 4.0f * std::abs(fract(v * 6.0f) - 0.5f));
            const float clods = noise(141, u, v, 48, 3);
            const vec3 soil = mix(vec3(0.33f, 0.23f, 0.15f), vec3(0.50f, 0.37f, 0.26f), std::clamp(furrow, 0.0f, 1.0f));
            return Texel{soil * (1.0f + 0.15f * clods), 0.10f * furrow + 0.03f * clods};
          }};
}

SurfacePattern cropRows() {
  return {"crop_rows", 256, vec2(4.0f), [](float u, float v) {
            const float row = 1.0f - std::abs(fract(v * 5.0f) - 0.5f) * 2.0f;
            const float leaves = noise(151, u, v, 40, 3);
            const float plant = smoothstep(0.25f, 0.55f, row + 0.3f * leaves);
            const vec3 color =
                mix(vec3(0.42f, 0.31f, 0.21f), vec3(0.36f, 0.52f, 0.20f) * (1.0f + 0.2f * leaves), plant);
            return Texel{color, 0.12f * plant + 0.04f * leaves};
          }};
}

SurfacePattern wheat() {
  return {"wheat", 256, vec2(4.0f), [](float u, float v) {
            const float ears = noise(161, u, v, 96, 2), wind = noise(162, u, v, 5, 3);
            const float line = std::abs(fract(v * 4.0f) - 0.5f) < 0.06f ? 0.85f : 1.0f;
            return Texel{vec3(0.83f, 0.68f, 0.36f) * (1.0f + 0.16f * ears + 0.08f * wind) * line, 0.05f * ears};
          }};
}

namespace {

/// Panes of a casement with two by three lights: metres to the nearest glazing bar, negative on it.
float paneDistance(float u, float v) {
  const vec2 size{1.1f, 1.5f};
  const vec2 p = vec2(u, v) * size;
  const float border = std::min({p.x, p.y, size.x - p.x, size.y - p.y}) - 0.07f;
  const float upright = std::abs(p.x - 0.55f) - 0.035f;
  const float transom = std::min(std::abs(p.y - 0.50f), std::abs(p.y - 1.0f)) - 0.02f;
  return std::min({border, upright, transom});
}

}  // namespace

SurfacePattern window() {
  return {"window", 128, vec2(1.1f, 1.5f), [](float u, float v) {
            const float glass = smoothstep(0.0f, 0.012f, paneDistance(u, v));
            const float curtain = smoothstep(0.28f, 0.40f, std::abs(u - 0.5f) - 0.10f * v);
            const vec3 pane = mix(vec3(0.16f, 0.19f, 0.23f), vec3(0.52f, 0.50f, 0.47f), 0.7f * curtain);
            return Texel{mix(vec3(0.90f, 0.88f, 0.83f), pane, glass), -0.02f * glass, mix(0.7f, 0.12f, glass)};
          }};
}

SurfacePattern litWindow() {
  return {"window_lit", 128, vec2(1.1f, 1.5f), [](float u, float v) {
            const float glass = smoothstep(0.0f, 0.012f, paneDistance(u, v));
            const float curtain = smoothstep(0.24f, 0.40f, std::abs(u - 0.5f) - 0.10f * v);
            const float lamp = 1.0f - 0.6f * glm::distance(vec2(u, v), vec2(0.5f, 0.35f));
            return Texel{vec3(1.0f, 0.86f, 0.60f) * glass * lamp * mix(1.0f, 0.55f, curtain)};
          }};
}

SurfacePattern door() {
  return {"door", 128, vec2(1.2f, 2.2f), [](float u, float v) {
            const vec2 p{u * 1.2f, v * 2.2f};
            const float leaf = std::abs(p.x - 0.6f);
            const float frame = std::min(std::min(p.x, 1.2f - p.x), p.y) - 0.08f;
            const float panel_x = 0.17f - std::abs(leaf - 0.28f);
            const float panel_y = std::min(0.30f - std::abs(p.y - 1.75f), 1.0f) > 0.0f ? 0.30f - std::abs(p.y - 1.75f)
                                                                                       : 0.45f - std::abs(p.y - 0.85f);
            const float panel = smoothstep(0.0f, 0.03f, std::min(panel_x, panel_y));
            const float grain = fractalNoise(171, u * 60.0f, v * 4.0f, 2, 0);
            vec3 color = vec3(0.62f, 0.60f, 0.58f) * (1.0f + 0.08f * grain) * mix(1.0f, 0.82f, panel);
            if (leaf < 0.012f) color *= 0.4f;
            if (frame < 0.0f) color = vec3(0.85f, 0.83f, 0.78f);
            return Texel{color, -0.015f * panel};
          }};
}

SurfacePattern bark() {
  return {"bark", 128, vec2(1.0f, 2.0f), [](float u, float v) {
            const float ridges = fractalNoise(181, u * 12.0f, v * 4.0f, 3, 12);
            return Texel{vec3(0.40f, 0.31f, 0.23f) * (1.0f + 0.35f * ridges), 0.03f * ridges};
          }};
}

SurfacePattern foliage() {
  return {"foliage", 512, vec2(3.0f), [](float u, float v) {
            const Cellular leaf = cellular(191, u, v, 34, 1.0f);
            const float clump = noise(192, u, v, 7, 3);
            const float lift = std::max(0.0f, 1.0f - leaf.nearest);
            const vec3 green = mix(vec3(0.27f, 0.35f, 0.17f), vec3(0.45f, 0.52f, 0.26f), leaf.tint);
            return Texel{green * (0.68f + 0.32f * smoothstep(0.0f, 0.5f, leaf.border)) * (1.0f + 0.30f * clump),
                         0.05f * lift + 0.07f * leaf.tint + 0.10f * clump};
          }};
}

SurfacePattern needles() {
  return {"needles", 256, vec2(2.0f), [](float u, float v) {
            const Cellular twig = cellular(201, u, v, 20, 1.0f);
            const float strands = noise(203, u, v, 48, 2), clump = noise(202, u, v, 7, 3);
            const vec3 green = mix(vec3(0.17f, 0.26f, 0.18f), vec3(0.29f, 0.39f, 0.24f), twig.tint);
            return Texel{green * (1.0f + 0.22f * strands + 0.35f * clump),
                         0.03f * strands + 0.05f * twig.tint + 0.16f * clump};
          }};
}

SurfacePattern canopy() {
  // Woods seen from far away: crowns of about 6 m, dark between them.
  return {"canopy", 256, vec2(72.0f), [](float u, float v) {
            const Cellular crown = cellular(221, u, v, 12, 1.0f);
            const float leaves = noise(222, u, v, 48, 3), stands = noise(223, u, v, 3, 2);
            const float dome = std::max(0.0f, 1.0f - crown.nearest * crown.nearest);
            const vec3 green = mix(vec3(0.20f, 0.28f, 0.17f), vec3(0.36f, 0.42f, 0.22f),
                                   0.6f * crown.tint + 0.4f * (0.5f + 0.5f * stands));
            return Texel{green * mix(0.82f, 1.0f, smoothstep(0.0f, 0.45f, crown.border)) * (1.0f + 0.30f * leaves),
                         1.8f * dome + 0.5f * leaves};
          }};
}

SurfacePattern stripes() {
  return {"stripes", 64, vec2(0.8f), [](float u, float v) {
            const float cloth = 1.0f + 0.04f * noise(211, u, v, 24, 2);
            return Texel{(u < 0.5f ? vec3(0.92f, 0.90f, 0.85f) : vec3(0.62f, 0.62f, 0.62f)) * cloth};
          }};
}

}  // namespace helio::scene::patterns
