// Convex polygons and rectangles in the ground plane (x, z). Counter-clockwise in (x, z): the inside is on the left of
// each edge. Double precision: plans are exact, meshes are rounded once at the end.
#pragma once

#include <array>
#include <vector>

#include <glm/glm.hpp>

namespace helio::scene {

using Polygon = std::vector<glm::dvec2>;

/// Inside where dot(normal, p) >= offset; `normal` is unit.
struct HalfPlane {
  glm::dvec2 normal{0.0};
  double offset = 0.0;

  double distance(const glm::dvec2& p) const { return glm::dot(normal, p) - offset; }
};

/// The half-plane on the left of the line from `a` to `b`.
HalfPlane leftOf(const glm::dvec2& a, const glm::dvec2& b);
std::vector<HalfPlane> halfPlanes(const Polygon& polygon);

/// Cuts a convex polygon in two. Either part may come back empty. Vertices within 1e-7 m of the line belong to both.
void split(const Polygon& polygon, const HalfPlane& line, Polygon& inside, Polygon& outside);
Polygon clip(const Polygon& polygon, const std::vector<HalfPlane>& planes);

double area(const Polygon& polygon);
glm::dvec2 centroid(const Polygon& polygon);
bool contains(const Polygon& polygon, const glm::dvec2& p, double margin = 0.0);

/// The polygon with edge i moved inwards by insets[i]; empty where nothing is left.
Polygon inset(const Polygon& polygon, const std::vector<double>& insets);
Polygon inset(const Polygon& polygon, double distance);
/// The polygon with every corner cut off `distance` metres from it.
Polygon chamfer(const Polygon& polygon, double distance);

struct Box2 {
  glm::dvec2 min{1e300}, max{-1e300};

  void grow(const glm::dvec2& p) {
    min = glm::min(min, p);
    max = glm::max(max, p);
  }
  bool overlaps(const Box2& other) const {
    return min.x <= other.max.x && other.min.x <= max.x && min.y <= other.max.y && other.min.y <= max.y;
  }
};
Box2 bounds(const Polygon& polygon);

/// A rectangle in any direction: what a thing covers of the ground.
struct Rectangle {
  glm::dvec2 centre{0.0};
  glm::dvec2 axis{1.0, 0.0};  ///< unit, along half.x
  glm::dvec2 half{0.0};

  std::array<glm::dvec2, 4> corners() const;
};
bool overlap(const Rectangle& a, const Rectangle& b);
bool inside(const Rectangle& rectangle, const Polygon& polygon);
/// Distance of `p` from the rectangle, 0 inside.
double distance(const Rectangle& rectangle, const glm::dvec2& p);
/// The smallest rectangle around a convex polygon with a side on one of its edges; half.x >= half.y.
Rectangle orientedBounds(const Polygon& polygon);

}  // namespace helio::scene
