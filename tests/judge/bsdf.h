// glTF's metallic-roughness material in double, written from the specification (glTF 2.0, appendix B; the base under
// the coat from Kelemen and Szirmay-Kalos) and not from the shaders: it is what they are judged by. Directions in the
// shading frame (z = shading normal), away from the surface.
#pragma once

#include <glm/glm.hpp>
#include <random>

namespace helio::judge {

inline constexpr double kPi = 3.14159265358979323846;

/// Below this alpha the renderer's convention is a perfect mirror.
inline constexpr double kMirrorAlpha = 1e-3;

struct Material {
  glm::dvec3 base{1.0};
  double metallic = 0.0;
  double roughness = 1.0;  ///< perceptual
  bool lambert = false;

  double alpha() const { return roughness * roughness; }
  bool mirror() const { return !lambert && alpha() < kMirrorAlpha; }
};

/// f(wo, wi), per steradian, without the cosine and without what a mirror reflects; 0 below the horizon.
glm::dvec3 evaluate(const Material& material, const glm::dvec3& wo, const glm::dvec3& wi);

/// Schlick's Fresnel reflectance of the material.
glm::dvec3 fresnel(const Material& material, double cosine);

/// The mean of (1 - cos)^5 between a direction and the microfacets of GGX that reflect it, as a fit: what makes
/// Schlick's Fresnel reflectance the directional albedo of a rough coat, f0 + (1 - f0) times this.
double meanPower(double cosine, double roughness);

struct Sample {
  glm::dvec3 wi{0.0};
  glm::dvec3 weight{0.0};  ///< f cos / density; 0: absorbed
};
/// Draws a direction: a coin between the cosine hemisphere and GGX's normals (D cos, not visible ones), both weighed by
/// their common density.
Sample sample(const Material& material, const glm::dvec3& wo, std::mt19937_64& random);

/// A number in [0, 1).
double uniform(std::mt19937_64& random);

}  // namespace helio::judge
