#include "effects/emitters.h"

#include <cmath>
#include <numeric>

namespace helio::effects {

AliasTable makeAliasTable(std::span<const float> weights) {
  const size_t n = weights.size();
  const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
  AliasTable table{std::vector<uint32_t>(n), std::vector<float>(n, 1.0f)};
  std::vector<double> scaled(n);
  std::vector<uint32_t> small, large;
  for (uint32_t i = 0; i < n; ++i) {
    table.alias[i] = i;
    scaled[i] = static_cast<double>(weights[i]) * static_cast<double>(n) / sum;
    (scaled[i] < 1.0 ? small : large).push_back(i);
  }
  // Fill each small entry up to 1 from a large one.
  while (!small.empty() && !large.empty()) {
    const uint32_t s = small.back(), l = large.back();
    small.pop_back();
    table.keep[s] = static_cast<float>(scaled[s]);
    table.alias[s] = l;
    scaled[l] -= 1.0 - scaled[s];
    if (scaled[l] < 1.0) {
      large.pop_back();
      small.push_back(l);
    }
  }
  return table;
}

namespace {

constexpr glm::vec3 kLuminance(0.2126f, 0.7152f, 0.0722f);

/// A mesh's emissive triangles, added up: seen from afar, those of a closed mesh shine alike to all sides and those of
/// a plane with the cosine.
class ShapeSum {
 public:
  void add(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, const glm::vec3& emission) {
    const glm::vec3 area = 0.5f * glm::cross(b - a, c - a);
    const float luminance = glm::dot(emission, kLuminance), power = glm::length(area) * luminance;
    power_ += power;
    centre_ += glm::dvec3(power / 3.0f * (a + b + c));
    normal_ += glm::dvec3(area * luminance);
    colour_ += glm::dvec3(glm::length(area) * emission);
  }
  shared::LampShape shape() const {
    shared::LampShape shape{};
    if (!(power_ > 0.0)) return shape;
    const double straight = glm::length(normal_);
    shape.centre = glm::vec3(centre_ / power_);
    shape.flatness = static_cast<float>(straight / power_);
    shape.normal = straight > 0.0 ? glm::vec3(normal_ / straight) : glm::vec3(0.0f, 1.0f, 0.0f);
    shape.colour = glm::vec3(colour_ / power_);
    return shape;
  }

 private:
  double power_ = 0.0;
  glm::dvec3 centre_{0.0}, normal_{0.0}, colour_{0.0};
};

}  // namespace

EmitterTriangles collectEmitters(const scene::Scene& scene) {
  EmitterTriangles result;
  for (const scene::Mesh& mesh : scene.meshes) {
    MeshEmitters emitters;
    emitters.first = static_cast<uint32_t>(result.triangles.size());
    std::vector<float> powers;
    ShapeSum shape;
    for (uint32_t g = 0; g < mesh.submeshes.size(); ++g) {
      const scene::Submesh& submesh = mesh.submeshes[g];
      const float radiance = glm::dot(scene.materials[submesh.material].emission, kLuminance);
      emitters.geometry_offset.push_back(radiance > 0.0f ? static_cast<uint32_t>(powers.size()) : shared::kNoTexture);
      if (!(radiance > 0.0f)) continue;
      for (uint32_t t = 0; t < submesh.index_count / 3; ++t) {
        const uint32_t* index = &mesh.indices[submesh.first_index + 3 * t];
        const glm::vec3 a = mesh.positions[index[0]], b = mesh.positions[index[1]], c = mesh.positions[index[2]];
        powers.push_back(0.5f * glm::length(glm::cross(b - a, c - a)) * radiance);
        shape.add(a, b, c, scene.materials[submesh.material].emission);
        result.triangles.push_back({g, t, 0, 1.0f, 0.0f});
      }
    }
    const double sum = std::accumulate(powers.begin(), powers.end(), 0.0);
    emitters.count = sum > 0.0 ? static_cast<uint32_t>(powers.size()) : 0;
    emitters.power = static_cast<float>(sum);
    if (emitters.count) {
      const AliasTable table = makeAliasTable(powers);
      for (uint32_t i = 0; i < emitters.count; ++i) {
        shared::EmitterTriangle& triangle = result.triangles[emitters.first + i];
        triangle.alias = table.alias[i];
        triangle.keep = table.keep[i];
        triangle.pmf = static_cast<float>(powers[i] / sum);
      }
    }
    result.meshes.push_back(std::move(emitters));
    result.shapes.push_back(shape.shape());
  }
  return result;
}

float emitterWeight(float mesh_power, const glm::mat4x3& transform) {
  return mesh_power * std::pow(std::abs(glm::determinant(glm::mat3(transform))), 2.0f / 3.0f);
}

}  // namespace helio::effects
