#include "scene/polygon.h"

#include <algorithm>
#include <cmath>

namespace helio::scene {
namespace {

constexpr double kOnLine = 1e-7;  // metres; far above double rounding at 10 km, far below anything visible

glm::dvec2 rotateLeft(const glm::dvec2& v) { return {-v.y, v.x}; }

}  // namespace

HalfPlane leftOf(const glm::dvec2& a, const glm::dvec2& b) {
  const glm::dvec2 normal = rotateLeft(glm::normalize(b - a));
  return {normal, glm::dot(normal, a)};
}

std::vector<HalfPlane> halfPlanes(const Polygon& polygon) {
  std::vector<HalfPlane> planes;
  for (size_t i = 0; i < polygon.size(); ++i) planes.push_back(leftOf(polygon[i], polygon[(i + 1) % polygon.size()]));
  return planes;
}

void split(const Polygon& polygon, const HalfPlane& line, Polygon& inside, Polygon& outside) {
  inside.clear();
  outside.clear();
  bool any_inside = false, any_outside = false;
  for (size_t i = 0; i < polygon.size(); ++i) {
    const glm::dvec2 a = polygon[i], b = polygon[(i + 1) % polygon.size()];
    const double da = line.distance(a), db = line.distance(b);
    if (da >= -kOnLine) inside.push_back(a);
    if (da <= kOnLine) outside.push_back(a);
    any_inside |= da > kOnLine;
    any_outside |= da < -kOnLine;
    if ((da > kOnLine && db < -kOnLine) || (da < -kOnLine && db > kOnLine)) {
      // From the same end whichever way round the edge runs: neighbours get the same point.
      const bool forward = a.x < b.x || (a.x == b.x && a.y < b.y);
      const glm::dvec2 cut = forward ? a + (b - a) * (da / (da - db)) : b + (a - b) * (db / (db - da));
      inside.push_back(cut);
      outside.push_back(cut);
    }
  }
  if (!any_inside) inside.clear();
  if (!any_outside) outside.clear();
}

Polygon clip(const Polygon& polygon, const std::vector<HalfPlane>& planes) {
  Polygon kept = polygon, inside, outside;
  for (const HalfPlane& plane : planes) {
    split(kept, plane, inside, outside);
    kept.swap(inside);
    if (kept.empty()) break;
  }
  return kept;
}

double area(const Polygon& polygon) {
  double doubled = 0.0;
  for (size_t i = 0; i < polygon.size(); ++i) {
    const glm::dvec2 a = polygon[i] - polygon[0], b = polygon[(i + 1) % polygon.size()] - polygon[0];
    doubled += a.x * b.y - a.y * b.x;
  }
  return 0.5 * doubled;
}

glm::dvec2 centroid(const Polygon& polygon) {
  glm::dvec2 weighted(0.0);
  double doubled = 0.0;
  for (size_t i = 1; i + 1 < polygon.size(); ++i) {
    const glm::dvec2 a = polygon[i] - polygon[0], b = polygon[i + 1] - polygon[0];
    const double cross = a.x * b.y - a.y * b.x;
    weighted += cross * (a + b) / 3.0;
    doubled += cross;
  }
  return doubled > 0.0 ? polygon[0] + weighted / doubled : polygon[0];
}

bool contains(const Polygon& polygon, const glm::dvec2& p, double margin) {
  if (polygon.empty()) return false;
  for (size_t i = 0; i < polygon.size(); ++i) {
    if (leftOf(polygon[i], polygon[(i + 1) % polygon.size()]).distance(p) < margin) return false;
  }
  return true;
}

Polygon inset(const Polygon& polygon, const std::vector<double>& insets) {
  std::vector<HalfPlane> planes = halfPlanes(polygon);
  for (size_t i = 0; i < planes.size(); ++i) planes[i].offset += insets[i];
  return clip(polygon, planes);
}

Polygon inset(const Polygon& polygon, double distance) {
  return inset(polygon, std::vector<double>(polygon.size(), distance));
}

Polygon chamfer(const Polygon& polygon, double distance) {
  Polygon result;
  const size_t count = polygon.size();
  for (size_t i = 0; i < count; ++i) {
    const glm::dvec2 previous = polygon[(i + count - 1) % count], corner = polygon[i], next = polygon[(i + 1) % count];
    const double before = glm::distance(previous, corner), after = glm::distance(corner, next);
    result.push_back(corner + (previous - corner) * (std::min(distance, 0.4 * before) / before));
    result.push_back(corner + (next - corner) * (std::min(distance, 0.4 * after) / after));
  }
  return result;
}

Box2 bounds(const Polygon& polygon) {
  Box2 box;
  for (const glm::dvec2& p : polygon) box.grow(p);
  return box;
}

std::array<glm::dvec2, 4> Rectangle::corners() const {
  const glm::dvec2 u = axis * half.x, v = rotateLeft(axis) * half.y;
  return {centre - u - v, centre + u - v, centre + u + v, centre - u + v};
}

bool overlap(const Rectangle& a, const Rectangle& b) {
  // Separating axes: two rectangles are apart exactly when a side's direction separates them.
  const glm::dvec2 between = b.centre - a.centre;
  for (const glm::dvec2& axis : {a.axis, rotateLeft(a.axis), b.axis, rotateLeft(b.axis)}) {
    const auto reach = [&](const Rectangle& r) {
      return std::abs(glm::dot(axis, r.axis)) * r.half.x + std::abs(glm::dot(axis, rotateLeft(r.axis))) * r.half.y;
    };
    if (std::abs(glm::dot(axis, between)) >= reach(a) + reach(b)) return false;
  }
  return true;
}

bool inside(const Rectangle& rectangle, const Polygon& polygon) {
  for (const glm::dvec2& corner : rectangle.corners()) {
    if (!contains(polygon, corner)) return false;
  }
  return true;
}

double distance(const Rectangle& rectangle, const glm::dvec2& p) {
  const glm::dvec2 local{glm::dot(p - rectangle.centre, rectangle.axis),
                         glm::dot(p - rectangle.centre, rotateLeft(rectangle.axis))};
  return glm::length(glm::max(glm::abs(local) - rectangle.half, glm::dvec2(0.0)));
}

Rectangle orientedBounds(const Polygon& polygon) {
  Rectangle best;
  double best_area = 1e300;
  for (size_t i = 0; i < polygon.size(); ++i) {
    const glm::dvec2 axis = glm::normalize(polygon[(i + 1) % polygon.size()] - polygon[i]);
    Box2 box;
    for (const glm::dvec2& p : polygon) box.grow({glm::dot(p, axis), glm::dot(p, rotateLeft(axis))});
    const glm::dvec2 extent = box.max - box.min;
    if (extent.x * extent.y >= best_area) continue;
    best_area = extent.x * extent.y;
    const glm::dvec2 middle = 0.5 * (box.min + box.max);
    best = {axis * middle.x + rotateLeft(axis) * middle.y, axis, 0.5 * extent};
  }
  if (best.half.x < best.half.y) {
    best.axis = rotateLeft(best.axis);
    best.half = {best.half.y, best.half.x};
  }
  return best;
}

}  // namespace helio::scene
