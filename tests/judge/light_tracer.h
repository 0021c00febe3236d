// The same light from the other end: particles from the lamps, connected to the camera at each surface [Arvo 1986,
// Dutre et al. 1993], in double. It finds at once what paths from the camera find by chance, such as the light that
// leaves one face of a lamp. Lambert surfaces only.
#pragma once

#include "judge/geometry.h"
#include "judge/path_tracer.h"

namespace helio::judge {

/// A mean with its standard error, by channel.
struct Estimate {
  glm::dvec3 mean{0.0}, error{0.0};
};

class LightTracer {
 public:
  /// Throws std::invalid_argument when a material is not Lambert, or nothing shines.
  explicit LightTracer(scene::ScenePtr scene);

  /// Mean radiance of the picture from light that leaves the lamps on the side of `facing`: the faces whose normal has
  /// a positive product with it. `particles`: of all, at least 64. The same seed gives the same estimate.
  Estimate meanRadiance(const scene::Camera& camera, const Picture& picture, const glm::dvec3& facing,
                        uint64_t particles, uint64_t seed) const;

 private:
  struct Lamp {
    glm::dvec3 corner, a, b;  // corner + u a + v b
    glm::dvec3 normal;        // unit
    glm::dvec3 emission;
    double area;
  };
  glm::dvec3 trace(const Lamp& lamp, const glm::dvec3& normal, const scene::Camera& camera, const Picture& picture,
                   std::mt19937_64& random) const;
  /// Of a particle that leaves `p` on the side of `normal` with Lambert's cosine and flux 1: what the picture's mean
  /// gets.
  double seenBy(const scene::Camera& camera, const Picture& picture, const glm::dvec3& p,
                const glm::dvec3& normal) const;

  scene::ScenePtr scene_;
  Geometry geometry_;
  std::vector<Lamp> lamps_;
};

}  // namespace helio::judge
