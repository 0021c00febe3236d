#include "effects/ggx_albedo.h"

#include <algorithm>
#include <cmath>

namespace helio::effects {
namespace {

constexpr int kStrata = 24;  // a side of the square of samples

double lambda(const glm::dvec3& w, double alpha) {
  const double cos2 = w.z * w.z;
  return 0.5 * (std::sqrt(1.0 + alpha * alpha * std::max(0.0, 1.0 - cos2) / std::max(cos2, 1e-12)) - 1.0);
}

/// Normal visible from `wo`, by projection onto the visible half of the stretched sphere [Heitz 2018, listing 1].
glm::dvec3 visibleNormal(const glm::dvec3& wo, double alpha, double u, double v) {
  const glm::dvec3 view = glm::normalize(glm::dvec3(alpha * wo.x, alpha * wo.y, wo.z));
  const double length = std::hypot(view.x, view.y);
  const glm::dvec3 t1 = length > 1e-9 ? glm::dvec3(-view.y, view.x, 0.0) / length : glm::dvec3(1.0, 0.0, 0.0);
  const glm::dvec3 t2 = glm::cross(view, t1);
  const double r = std::sqrt(u), phi = 2.0 * 3.14159265358979 * v, s = 0.5 * (1.0 + view.z);
  const double x = r * std::cos(phi);
  const double y = (1.0 - s) * std::sqrt(std::max(0.0, 1.0 - x * x)) + s * r * std::sin(phi);
  const glm::dvec3 n = x * t1 + y * t2 + std::sqrt(std::max(0.0, 1.0 - x * x - y * y)) * view;
  return glm::normalize(glm::dvec3(alpha * n.x, alpha * n.y, std::max(1e-9, n.z)));
}

double albedo(double cosine, double alpha) {
  const glm::dvec3 wo(std::sqrt(1.0 - cosine * cosine), 0.0, cosine);
  double sum = 0.0;
  for (int i = 0; i < kStrata; ++i)
    for (int j = 0; j < kStrata; ++j) {
      const glm::dvec3 h = visibleNormal(wo, alpha, (i + 0.5) / kStrata, (j + 0.5) / kStrata);
      const glm::dvec3 wi = 2.0 * glm::dot(wo, h) * h - wo;
      if (wi.z <= 0.0) continue;
      const double at_wo = lambda(wo, alpha);
      sum += (1.0 + at_wo) / (1.0 + at_wo + lambda(wi, alpha));
    }
  return sum / (kStrata * kStrata);
}

}  // namespace

shared::GgxAlbedo ggxAlbedo() {
  shared::GgxAlbedo table{};
  for (uint32_t row = 0; row < shared::kGgxAlbedoAlphas; ++row) {
    const double roughness = static_cast<double>(row) / (shared::kGgxAlbedoAlphas - 1);
    for (uint32_t column = 0; column < shared::kGgxAlbedoCosines; ++column) {
      const double cosine = std::max(1e-3, static_cast<double>(column) / (shared::kGgxAlbedoCosines - 1));
      table.share[row * shared::kGgxAlbedoCosines + column] =
          row == 0 ? 1.0f : static_cast<float>(albedo(cosine, roughness * roughness));
    }
  }
  return table;
}

}  // namespace helio::effects
