#include "world/grid.h"

#include <cmath>

namespace helio::world {

// Saturates: what lies beyond any world shares the outermost cells, and not-a-number becomes one of them.
int32_t HitboxGrid::cellCoordinate(double metres) {
  constexpr double kFarthest = 1 << 30;
  const double cell = std::floor(metres / kCellSize);
  if (!(cell > -kFarthest)) return static_cast<int32_t>(-kFarthest);
  return static_cast<int32_t>(cell < kFarthest ? cell : kFarthest);
}

void HitboxGrid::insert(uint32_t item, glm::vec2 xz) {
  if (item >= entries_.size()) entries_.resize(item + size_t{1});
  const CellKey key = keyOf(cellCoordinate(xz.x), cellCoordinate(xz.y));
  std::vector<uint32_t>& cell = cells_[key];
  entries_[item] = {xz, key, static_cast<uint32_t>(cell.size())};
  cell.push_back(item);
}

void HitboxGrid::remove(uint32_t item) {
  const Entry entry = entries_[item];
  const auto cell = cells_.find(entry.cell);
  std::vector<uint32_t>& items = cell->second;
  items[entry.place] = items.back();  // order within a cell does not matter
  entries_[items[entry.place]].place = entry.place;
  items.pop_back();
  if (items.empty()) cells_.erase(cell);
}

}  // namespace helio::world
