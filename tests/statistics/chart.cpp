#include "chart.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace helio::test {
namespace {

constexpr double kPi = 3.14159265358979323846;
/// Single-precision directions may lie this much, relatively, beyond the edge of the cap.
constexpr double kEdge = 1e-4;

/// Gauss and Legendre's rule with four nodes, on [0, 1].
constexpr std::array<double, 4> kPoints = {0.06943184420297371, 0.33000947820757187, 0.66999052179242813,
                                           0.93056815579702629};
constexpr std::array<double, 4> kWeights = {0.17392742256872693, 0.32607257743127307, 0.32607257743127307,
                                            0.17392742256872693};

/// Node `i` along a side, and its weight: the rule repeated over panels of equal length.
double point(size_t i) {
  return (static_cast<double>(i / 4) + kPoints[i % 4]) * 4.0 / static_cast<double>(Chart::kCells * Chart::kNodes);
}
double weight(size_t i) { return kWeights[i % 4] * 4.0 / static_cast<double>(Chart::kCells * Chart::kNodes); }

}  // namespace

// Half of the cells are spread evenly, the others as x (1 + k) / (x + k).
double Warp::inverse(double x) const { return 0.5 * (x + x * (1.0 + sharpness_) / (x + sharpness_)); }

double Warp::forward(double s) const {
  // inverse() solved for x: x^2 + b x - c = 0.
  const double b = 1.0 + 2.0 * sharpness_ - 2.0 * s, c = 2.0 * s * sharpness_;
  const double root = std::sqrt(b * b + 4.0 * c);
  return b > 0.0 ? 2.0 * c / (b + root) : 0.5 * (root - b);
}

double Warp::derivative(double s) const {
  const double x = forward(s);
  return 2.0 / (1.0 + sharpness_ * (1.0 + sharpness_) / std::pow(x + sharpness_, 2.0));
}

Chart::Chart(const glm::dvec3& axis, const glm::dvec3& azimuth, double extent, bool from_rim, Warp polar, Warp sector)
    : axis_(glm::normalize(axis)), extent_(extent), from_rim_(from_rim), polar_(polar), sector_(sector) {
  x_ = glm::normalize(azimuth - axis_ * glm::dot(azimuth, axis_));
  y_ = glm::cross(axis_, x_);
}

Chart Chart::cap(const glm::dvec3& axis, double extent, double sharpness) {
  const glm::dvec3 aside = std::abs(axis.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  return {axis, aside, extent, false, Warp(sharpness), Warp(1e6)};
}

Chart Chart::horizon(const glm::dvec3& towards, double low, double aside) {
  return {glm::dvec3(0, 0, 1), towards, 0.5, true, Warp(low), Warp(aside)};
}

std::vector<Chart::Node> Chart::nodes() const {
  std::vector<Node> result;
  result.reserve(kCellCount * kNodesPerCell);
  for (size_t cell = 0; cell < kCellCount; ++cell)
    for (size_t node = 0; node < kNodesPerCell; ++node) {
      const size_t i = cell / kCells * kNodes + node / kNodes, j = cell % kCells * kNodes + node % kNodes;
      const double ring = polar_.forward(point(i));
      const double q = extent_ * (from_rim_ ? 1.0 - ring : ring);  // (1 - cos) / 2: d omega = 2 dq d phi
      // Sectors go both ways from x.
      const double turn = 2.0 * point(j) - 1.0;
      const double phi = std::copysign(kPi * sector_.forward(std::abs(turn)), turn);
      const double sine = 2.0 * std::sqrt(q * (1.0 - q));
      const double dq = extent_ * polar_.derivative(point(i)) * weight(i);
      const double dphi = 2.0 * kPi * sector_.derivative(std::abs(turn)) * weight(j);
      result.push_back(
          {sine * std::cos(phi) * x_ + sine * std::sin(phi) * y_ + (1.0 - 2.0 * q) * axis_, 2.0 * dq * dphi});
    }
  return result;
}

size_t Chart::cellOf(const glm::dvec3& w) const {
  // |w - axis|^2 / 4 keeps its digits for narrow caps.
  const glm::dvec3 unit = glm::normalize(w), difference = unit - axis_;
  const double q = 0.25 * glm::dot(difference, difference) / extent_;
  if (!(q <= 1.0 + kEdge)) return kCellCount;
  const double ring = polar_.inverse(from_rim_ ? std::max(0.0, 1.0 - q) : q);
  const double phi = std::atan2(glm::dot(unit, y_), glm::dot(unit, x_));
  const double turn = std::copysign(sector_.inverse(std::abs(phi) / kPi), phi);
  const auto index = [](double v) {
    return std::min(kCells - 1, static_cast<size_t>(v * static_cast<double>(kCells)));
  };
  return index(ring) * kCells + index(0.5 + 0.5 * turn);
}

}  // namespace helio::test
