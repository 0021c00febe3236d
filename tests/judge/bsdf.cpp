#include "judge/bsdf.h"

#include <algorithm>
#include <cmath>

namespace helio::judge {
namespace {

/// Trowbridge and Reitz's distribution of normals, as the specification writes it.
double distribution(double cosine, double alpha) {
  const double a2 = alpha * alpha, d = cosine * cosine * (a2 - 1.0) + 1.0;
  return a2 / (kPi * d * d);
}

/// G / (4 cos cos), height-correlated [Heitz 2014].
double visibility(double cos_o, double cos_i, double alpha) {
  const double a2 = alpha * alpha;
  return 0.5 /
         (cos_i * std::sqrt(a2 + (1.0 - a2) * cos_o * cos_o) + cos_o * std::sqrt(a2 + (1.0 - a2) * cos_i * cos_i));
}

glm::dvec3 cosineWeighted(std::mt19937_64& random) {
  // Malley's method.
  const double radius = std::sqrt(uniform(random)), phi = 2.0 * kPi * uniform(random);
  return {radius * std::cos(phi), radius * std::sin(phi), std::sqrt(std::max(0.0, 1.0 - radius * radius))};
}

}  // namespace

double uniform(std::mt19937_64& random) { return static_cast<double>(random() >> 11) * 0x1p-53; }

glm::dvec3 fresnel(const Material& material, double cosine) {
  const glm::dvec3 f0 = glm::mix(glm::dvec3(0.04), material.base, material.metallic);
  return f0 + (1.0 - f0) * std::pow(1.0 - std::clamp(cosine, 0.0, 1.0), 5.0);
}

double meanPower(double cosine, double roughness) {
  const double power = 5.0 / (1.0 + 1.74 * roughness), scale = 1.0 / (1.0 + 24.3 * std::pow(roughness, 2.47));
  return scale * std::pow(1.0 - std::clamp(cosine, 0.0, 1.0), power);
}

glm::dvec3 evaluate(const Material& material, const glm::dvec3& wo, const glm::dvec3& wi) {
  if (wo.z <= 0.0 || wi.z <= 0.0) return glm::dvec3(0.0);
  if (material.lambert) return material.base / kPi;
  const glm::dvec3 half = glm::normalize(wo + wi);
  const glm::dvec3 f = fresnel(material, glm::dot(wo, half));
  // The base under the coat [Kelemen and Szirmay-Kalos 2001].
  const glm::dvec3 f0 = fresnel(material, 1.0);
  const auto through = [&](double mean_power) { return 1.0 - (f0 + (1.0 - f0) * mean_power); };
  const double power = 5.0 / (1.0 + 1.74 * material.roughness);
  const glm::dvec3 mean = through(meanPower(0.0, material.roughness) * 2.0 / ((power + 1.0) * (power + 2.0)));
  glm::dvec3 value = through(meanPower(wo.z, material.roughness)) * through(meanPower(wi.z, material.roughness)) /
                     glm::max(mean, glm::dvec3(1e-4)) * (1.0 - material.metallic) * material.base / kPi;
  if (!material.mirror())
    value += f * distribution(half.z, material.alpha()) * visibility(wo.z, wi.z, material.alpha());
  return value;
}

Sample sample(const Material& material, const glm::dvec3& wo, std::mt19937_64& random) {
  if (wo.z <= 0.0) return {};
  const double specular = material.lambert ? 0.0 : material.metallic == 1.0 && material.mirror() ? 1.0 : 0.5;
  glm::dvec3 wi;
  if (uniform(random) < specular) {
    if (material.mirror()) {
      wi = {-wo.x, -wo.y, wo.z};
      return {wi, fresnel(material, wo.z) / specular};
    }
    const double u = uniform(random), phi = 2.0 * kPi * uniform(random), alpha = material.alpha();
    const double tan2 = alpha * alpha * u / (1.0 - u), cosine = 1.0 / std::sqrt(1.0 + tan2);
    const double sine = std::sqrt(std::max(0.0, 1.0 - cosine * cosine));
    const glm::dvec3 half(sine * std::cos(phi), sine * std::sin(phi), cosine);
    wi = 2.0 * glm::dot(wo, half) * half - wo;
  } else {
    wi = cosineWeighted(random);
  }
  if (wi.z <= 0.0) return {};
  double density = (1.0 - specular) * wi.z / kPi;
  if (specular > 0.0 && !material.mirror()) {
    const glm::dvec3 half = glm::normalize(wo + wi);
    density += specular * distribution(half.z, material.alpha()) * half.z / (4.0 * glm::dot(wo, half));
  }
  return {wi, evaluate(material, wo, wi) * wi.z / density};
}

}  // namespace helio::judge
