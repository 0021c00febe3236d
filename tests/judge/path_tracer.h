// The second implementation: a plain path tracer in double that samples the BSDF and nothing else, so that it shares
// neither code nor method with the renderer it judges. Slow, and as simple as the rendering equation [Kajiya 1986].
#pragma once

#include "judge/bsdf.h"
#include "judge/geometry.h"

namespace helio::judge {

struct Picture {
  uint32_t width = 0;
  uint32_t height = 0;
  uint32_t bounces = 3;  ///< B: all paths of 0 to B + 1 scatterings
};

class PathTracer {
 public:
  /// Throws std::invalid_argument for textures, which it does not know.
  explicit PathTracer(scene::ScenePtr scene);

  /// Independent pictures, of `samples` paths a pixel each: rows top-down, three values a pixel, W/(sr m^2). The same
  /// seed gives the same pictures.
  std::vector<std::vector<double>> render(const scene::Camera& camera, const Picture& picture, uint32_t samples,
                                          uint32_t batches, uint64_t seed) const;

  /// One path's radiance.
  glm::dvec3 radiance(Ray ray, uint32_t bounces, std::mt19937_64& random) const;

 private:
  struct Surface {
    glm::dvec3 position, geometric_normal, normal;  // both normals on the ray's side
    uint32_t material;
  };
  Surface surfaceAt(const Ray& ray, const Intersection& hit) const;
  glm::dvec3 fromInfinity(const glm::dvec3& direction, bool scattered) const;

  scene::ScenePtr scene_;
  Geometry geometry_;
  std::vector<Material> materials_;
};

}  // namespace helio::judge
