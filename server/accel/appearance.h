// Latency mitigation of light path guided culling [Kelling et al. 2024, §3.6]: what has just come into a viewer's
// sight.
#pragma once

#include <map>
#include <set>
#include <span>
#include <vector>

#include "accel/instance_table.h"
#include "accel/lipac_settings.h"
#include "accel/units.h"
#include "shared/assemble.h"
#include "shared/lipac.h"

namespace helio::accel {

/// A viewer who renders in this tick.
struct Sight {
  uint64_t viewer = 0;
  shared::CullVolume volume;  ///< its frustum
};

/// Finds what comes into sight, and never looks at all instances: whole blocks of the order are compared with the
/// frustum of now and of the tick before, and the GPU looks into those that differ; instances with a BLAS of their own,
/// which the CPU must bring, are looked at one by one, as everything that moves is. What covers fewer of 1920 x 1080
/// pixels than the hits below which it leaves again is not worth it. Deterministic: a function of the sights so far.
class Appearance {
 public:
  explicit Appearance(const LipacSettings& settings) : settings_(settings), smoothing_(settings.smoothing) {}

  /// This tick's sights. `edited`: slots whose instances users changed.
  void begin(std::span<const Sight> sights, std::span<const uint32_t> edited, const InstanceTable& table,
             const Units& units);
  /// A unit of units() was brought, or had been: it is no longer new to those who see it.
  void noteShown(uint32_t unit);
  void remove(uint64_t viewer) { viewers_.erase(viewer); }
  /// Nobody has seen anything yet.
  void forget() { viewers_.clear(); }

  /// Blocks of the order, within the budget, the most prominent first; the rest waits for the next tick.
  const std::vector<shared::LipacSight>& blocks() const { return blocks_; }
  const std::vector<shared::CullVolume>& volumes() const { return volumes_; }
  /// Units that deform, the most prominent first.
  const std::vector<uint32_t>& units() const { return units_; }
  /// Edited slots that somebody sees.
  const std::vector<uint32_t>& slots() const { return slots_; }
  /// Ticks that hits are averaged over: since a camera cut, LipacSettings::smoothing at most. What was met before it
  /// says nothing about the new view.
  uint32_t smoothing() const { return smoothing_; }
  uint64_t visits() const { return visits_; }  ///< blocks and instances that begin() looked at

 private:
  struct Viewer {
    bool known = false;
    shared::CullVolume before{};
    std::set<uint32_t> waiting;    // blocks that the budget left out
    std::vector<bool> seen_units;  // by unit: it has been brought, or need not be
  };
  struct Ranked {
    float pixels;
    shared::LipacSight sight;
  };
  void findBlocks(const Sight& sight, uint32_t index, Viewer& viewer, const InstanceTable& table,
                  std::vector<Ranked>& ranked);

  LipacSettings settings_;
  std::map<uint64_t, Viewer> viewers_;
  uint32_t smoothing_;
  uint64_t visits_ = 0;
  std::vector<shared::LipacSight> blocks_;
  std::vector<shared::CullVolume> volumes_;
  std::vector<uint32_t> units_, slots_;
};

}  // namespace helio::accel
