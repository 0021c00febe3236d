#include "scene/cut_outs.h"

#include <algorithm>
#include <cmath>

namespace helio::scene {
namespace {

/// Triangles that cover the texture more often than this are taken to see all of it.
constexpr float kRepetitions = 4.0f;

int64_t wrapped(int64_t i, uint32_t size, Wrap wrap) {
  const auto n = static_cast<int64_t>(size);
  if (wrap == Wrap::clamp) return std::clamp<int64_t>(i, 0, n - 1);
  if (wrap == Wrap::repeat) return (i % n + n) % n;
  const int64_t there_and_back = (i % (2 * n) + 2 * n) % (2 * n);
  return std::min(there_and_back, 2 * n - 1 - there_and_back);
}

/// What a triangle covers of the band low <= y <= high, along x; empty: min > max.
struct Extent {
  float min = std::numeric_limits<float>::infinity();
  float max = -std::numeric_limits<float>::infinity();
  void grow(float x) {
    min = std::min(min, x);
    max = std::max(max, x);
  }
};
Extent extentInBand(const std::array<glm::vec2, 3>& p, float low, float high) {
  Extent extent;
  for (size_t i = 0; i < 3; ++i) {
    const glm::vec2 a = p[i], b = p[(i + 1) % 3];
    if (a.y >= low && a.y <= high) extent.grow(a.x);
    for (const float y : {low, high})
      if (std::min(a.y, b.y) < y && y < std::max(a.y, b.y)) extent.grow(a.x + (b.x - a.x) * ((y - a.y) / (b.y - a.y)));
  }
  return extent;
}

AlphaRange alphaOf(const Mesh& mesh, const Material& material, const std::vector<Texture>& textures,
                   const uint32_t* corners) {
  AlphaRange range{1.0f, 1.0f};
  if (material.base_color_texture != kNone) {
    const size_t channel = material.channel(TextureSlot::base_color);
    const std::vector<glm::vec2>& uvs = channel == 0 ? mesh.uvs : mesh.more_uvs[channel - 1];
    range = alphaWithin(textures[material.base_color_texture], {uvs[corners[0]], uvs[corners[1]], uvs[corners[2]]});
  }
  float least = material.base_color.a, greatest = least;
  if (!mesh.colors.empty()) {
    const std::array alphas{mesh.colors[corners[0]].a, mesh.colors[corners[1]].a, mesh.colors[corners[2]].a};
    least *= *std::min_element(alphas.begin(), alphas.end());
    greatest *= *std::max_element(alphas.begin(), alphas.end());
  }
  return {range.least * least, range.greatest * greatest};
}

}  // namespace

AlphaRange alphaWithin(const Texture& texture, const std::array<glm::vec2, 3>& uv) {
  // In texels; a read at p blends the four texels from floor(p) to floor(p) + 1.
  const glm::vec2 size(texture.width, texture.height);
  std::array<glm::vec2, 3> p;
  for (size_t i = 0; i < 3; ++i) p[i] = uv[i] * size - 0.5f;
  const glm::vec2 low = glm::min(p[0], glm::min(p[1], p[2])), high = glm::max(p[0], glm::max(p[1], p[2]));

  AlphaRange range;
  const auto read = [&](int64_t x, int64_t y) {
    const auto texel = static_cast<size_t>(wrapped(y, texture.height, texture.sampling.v) * texture.width +
                                           wrapped(x, texture.width, texture.sampling.u));
    const float alpha = static_cast<float>(texture.rgba[4 * texel + 3]) / 255.0f;
    range.least = std::min(range.least, alpha);
    range.greatest = std::max(range.greatest, alpha);
  };
  const glm::vec2 extent = (high - low) / size;
  if (!(std::max(extent.x, extent.y) < kRepetitions)) {
    for (int64_t y = 0; y < texture.height; ++y)
      for (int64_t x = 0; x < texture.width; ++x) read(x, y);
    return range;
  }
  for (auto y = static_cast<int64_t>(std::floor(low.y)); y <= static_cast<int64_t>(std::floor(high.y)) + 1; ++y) {
    // Reads between the rows above and below touch this row.
    const Extent row = extentInBand(p, static_cast<float>(y - 1), static_cast<float>(y + 1));
    if (row.min > row.max) continue;
    for (auto x = static_cast<int64_t>(std::floor(row.min)); x <= static_cast<int64_t>(std::floor(row.max)) + 1; ++x)
      read(x, y);
  }
  return range;
}

void splitCutOuts(Mesh& mesh, const std::vector<Material>& materials, const std::vector<Texture>& textures) {
  std::vector<uint32_t> indices;
  std::vector<Submesh> submeshes;
  const auto append = [&](const Submesh& like, bool whole, const std::vector<uint32_t>& triangles) {
    if (triangles.empty()) return;
    submeshes.push_back(
        {static_cast<uint32_t>(indices.size()), static_cast<uint32_t>(triangles.size()), like.material, whole});
    indices.insert(indices.end(), triangles.begin(), triangles.end());
  };
  for (const Submesh& submesh : mesh.submeshes) {
    const Material& material = materials[submesh.material];
    const uint32_t* first = &mesh.indices[submesh.first_index];
    if (!material.masked() || submesh.whole) {
      append(submesh, submesh.whole, {first, first + submesh.index_count});
      continue;
    }
    std::vector<uint32_t> whole, cut;
    for (const uint32_t* corners = first; corners < first + submesh.index_count; corners += 3) {
      const AlphaRange alpha = alphaOf(mesh, material, textures, corners);
      if (alpha.greatest < material.alpha_cutoff) continue;
      std::vector<uint32_t>& kept = alpha.least >= material.alpha_cutoff ? whole : cut;
      kept.insert(kept.end(), corners, corners + 3);
    }
    append(submesh, true, whole);
    append(submesh, false, cut);
  }
  mesh.indices = std::move(indices);
  mesh.submeshes = std::move(submeshes);
}

}  // namespace helio::scene
