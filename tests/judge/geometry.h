// A scene's triangles in world space and rays among them, in double.
#pragma once

#include <glm/glm.hpp>
#include <limits>
#include <optional>
#include <vector>

#include "scene/scene.h"

namespace helio::judge {

struct Triangle {
  glm::dvec3 p[3];
  glm::dvec3 normal[3];  ///< unit, of the vertices
  uint32_t material;
};

struct Ray {
  glm::dvec3 origin;
  glm::dvec3 direction;  ///< unit
};

struct Intersection {
  double t = std::numeric_limits<double>::infinity();
  uint32_t triangle = 0;
  double u = 0.0, v = 0.0;  ///< barycentrics of the second and third vertex
};

/// A binary tree of boxes over the placed triangles, split at the median of their centres.
class Geometry {
 public:
  explicit Geometry(const scene::Scene& scene);
  /// The nearest triangle farther than `least` metres along the ray.
  std::optional<Intersection> intersect(const Ray& ray, double least) const;
  const Triangle& triangle(uint32_t index) const { return triangles_[index]; }
  uint32_t size() const { return static_cast<uint32_t>(triangles_.size()); }

 private:
  struct Node {
    glm::dvec3 low, high;
    uint32_t first = 0, count = 0;  // of triangles; count 0: children at `first` and `first + 1`
  };
  void split(uint32_t node, uint32_t first, uint32_t count);

  std::vector<Triangle> triangles_;
  std::vector<Node> nodes_;
};

}  // namespace helio::judge
