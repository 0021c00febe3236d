// A chart of directions: the unit square onto a spherical cap, with its Jacobian, so that densities can be integrated
// over regular cells and samples counted in them. In double throughout.
#pragma once

#include <glm/glm.hpp>
#include <vector>

namespace helio::test {

/// A map of [0, 1] onto itself that crowds half of its cells within about `sharpness` > 0 of 0; large: the identity.
class Warp {
 public:
  explicit Warp(double sharpness) : sharpness_(sharpness) {}
  double forward(double s) const;     ///< x of a share of the cells
  double inverse(double x) const;     ///< the share of the cells below x
  double derivative(double s) const;  ///< dx / ds

 private:
  double sharpness_;
};

class Chart {
 public:
  static constexpr size_t kCells = 32;  ///< along each side
  static constexpr size_t kNodes = 24;  ///< of a cell along each side, for integrals
  static constexpr size_t kCellCount = kCells * kCells;
  static constexpr size_t kNodesPerCell = kNodes * kNodes;

  /// The cap of directions w with (1 - w . axis) / 2 <= `extent` in (0, 1], in rings whose half crowds within about the
  /// fraction `sharpness` of the cap.
  static Chart cap(const glm::dvec3& axis, double extent, double sharpness);
  /// The upper hemisphere, in layers of z whose half crowds within about `low` of the horizon, and sectors whose half
  /// crowds within about the fraction `aside` of a half turn from the azimuth of `towards`: for lobes at grazing views.
  static Chart horizon(const glm::dvec3& towards, double low, double aside);

  /// A direction and its solid angle, for quadrature by Gauss and Legendre.
  struct Node {
    glm::dvec3 direction;
    double solid_angle;
  };
  /// kNodesPerCell nodes of each cell, cell by cell.
  std::vector<Node> nodes() const;

  /// Cell of a direction of about unit length; kCellCount outside.
  size_t cellOf(const glm::dvec3& w) const;

 private:
  Chart(const glm::dvec3& axis, const glm::dvec3& azimuth, double extent, bool from_rim, Warp polar, Warp sector);

  glm::dvec3 x_, y_, axis_;
  double extent_;
  bool from_rim_;  // rings are counted from the rim inwards
  Warp polar_, sector_;
};

}  // namespace helio::test
