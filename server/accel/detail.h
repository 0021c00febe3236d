// Which level of detail of its mesh every instance has in the acceleration structures.
#pragma once

#include <span>
#include <vector>

#include "accel/instance_table.h"
#include "accel/strategy.h"
#include "accel/units.h"

namespace helio::accel {

/// What one tick may switch. Counts, not times: the same world gives the same ticks.
struct DetailBudget {
  uint32_t blocks = 256;         ///< of the order that are looked at
  uint32_t switches = 4096;      ///< instances that change their level
  uint64_t triangles = 400'000;  ///< of the levels that they change to
};

/// An instance's level may be off by what its viewers tolerate at its distance (half a pixel of the one who sees it
/// largest). Blocks of the order are looked at again when their distance has changed, those it matters most to first,
/// and what moves in every tick; no tick looks at every instance. Deterministic: what it decides follows from viewers,
/// instances and what it decided before.
class Detail {
 public:
  explicit Detail(const scene::Scene& scene) : scene_(scene) {}

  /// This tick's viewers. One who wants no approximation makes every level the finest at once.
  void begin(std::span<const Viewpoint> viewers);
  /// The level for an instance, given the one that it has: a coarser one must be good enough by a margin, so that
  /// nothing swings between two. While nobody looks all stays as it is.
  uint32_t levelFor(const InstanceTable& table, uint32_t slot, uint32_t present) const;
  /// The levels with which instances come. They have no budget, for nothing is built for them.
  void place(InstanceTable& table, const world::ChangeSet& changes);
  /// Switches instances that have no BLAS of their own.
  void plan(InstanceTable& table, const Units& units);

  uint64_t cpuBytes() const { return looked_at_.capacity() * sizeof(float); }
  void setBudget(const DetailBudget& budget) { budget_ = budget; }
  bool finest() const { return finest_; }
  uint32_t switched() const { return switched_; }  ///< by the last plan()

 private:
  struct Eye {
    glm::vec3 position;
    float tolerance;  // metres off, a metre away
  };
  /// What may be off at a sphere, metres.
  float allowed(const glm::vec3& centre, float radius) const;
  bool planBlock(InstanceTable& table, size_t block);
  /// False: the budget is spent.
  bool plan(InstanceTable& table, uint32_t slot);

  const scene::Scene& scene_;
  DetailBudget budget_;
  std::vector<Eye> eyes_;
  bool finest_ = false;
  bool any_coarse_ = false;
  DetailBudget left_;  // of this tick
  uint32_t switched_ = 0;
  std::vector<float> looked_at_;  // by block: what was allowed when it was last looked at
};

}  // namespace helio::accel
