// The hitbox grid: points in the ground plane hashed into square cells, for cylinder queries.
#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

#include <glm/glm.hpp>

namespace helio::world {

/// A uniform grid over the x-z plane, unbounded, that holds only cells with something in them. Items are dense small
/// integers of the caller's (table slots). Insertion, removal and moving cost O(1) whatever the crowd in a cell.
/// Not thread-safe.
class HitboxGrid {
 public:
  static constexpr float kCellSize = 16.0f;  ///< metres

  /// Puts `item`, which must not be in the grid, at `xz` (metres).
  void insert(uint32_t item, glm::vec2 xz);
  /// Takes `item`, which must be in the grid, out.
  void remove(uint32_t item);

  /// Calls `visit(item)` for every item whose distance to `centre` is at most `radius`, in no particular order.
  template <typename Visit>
  void visitDisc(glm::vec2 centre, float radius, Visit&& visit) const;

 private:
  using CellKey = uint64_t;  // x cell in the upper half, z cell in the lower one
  struct Entry {
    glm::vec2 xz{0.0f};
    CellKey cell = 0;
    uint32_t place = 0;  // in its cell's list
  };

  static int32_t cellCoordinate(double metres);
  static CellKey keyOf(int32_t x, int32_t z) {
    return uint64_t{static_cast<uint32_t>(x)} << 32 | static_cast<uint32_t>(z);
  }

  std::unordered_map<CellKey, std::vector<uint32_t>> cells_;
  std::vector<Entry> entries_;  // by item
};

template <typename Visit>
void HitboxGrid::visitDisc(glm::vec2 centre, float radius, Visit&& visit) const {
  const double cx = centre.x, cz = centre.y, r = radius;
  const auto visitCell = [&](const std::vector<uint32_t>& items) {
    for (uint32_t item : items) {
      const double dx = entries_[item].xz.x - cx, dz = entries_[item].xz.y - cz;
      if (dx * dx + dz * dz <= r * r) visit(item);
    }
  };

  const int64_t x0 = cellCoordinate(cx - r), x1 = cellCoordinate(cx + r);
  const int64_t z0 = cellCoordinate(cz - r), z1 = cellCoordinate(cz + r);
  const double covered = static_cast<double>(x1 - x0 + 1) * static_cast<double>(z1 - z0 + 1);
  if (covered > static_cast<double>(cells_.size())) {  // cheaper to look at what exists than at what could
    for (const auto& [key, items] : cells_) visitCell(items);
    return;
  }
  for (int64_t x = x0; x <= x1; ++x) {
    for (int64_t z = z0; z <= z1; ++z) {
      const auto cell = cells_.find(keyOf(static_cast<int32_t>(x), static_cast<int32_t>(z)));
      if (cell != cells_.end()) visitCell(cell->second);
    }
  }
}

}  // namespace helio::world
