// Whose hits count in which tick: every viewer's once, then the feedback runs.
#pragma once

#include <cstdint>
#include <map>

namespace helio::accel {

/// Viewers may render at different rates. Between two feedbacks each viewer counts in one tick, so that a fast one
/// weighs no more than a slow one.
class ViewerQuorum {
 public:
  static constexpr uint64_t kIdleAfter = 300;  ///< ticks without a picture (5 s at 60 a second): nobody waits for it

  void add(uint64_t viewer) { viewers_[viewer] = {}; }
  void remove(uint64_t viewer) { viewers_.erase(viewer); }

  /// The viewer renders in this tick. True: its hits count.
  bool counts(uint64_t viewer, uint64_t tick);
  /// Every viewer that is not idle has counted: the feedback is due, and a new round begins.
  bool complete(uint64_t tick);

 private:
  struct Viewer {
    bool seen = false;
    bool counted = false;
    uint64_t tick = 0;  // of its last picture
  };
  std::map<uint64_t, Viewer> viewers_;
};

}  // namespace helio::accel
