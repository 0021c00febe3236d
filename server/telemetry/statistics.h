// What is counted while frames flow. Counters only grow; who watches keeps the last values and reports differences.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <mutex>
#include <utility>
#include <vector>

#include "render/renderer.h"

namespace helio::telemetry {

using Clock = std::chrono::steady_clock;

inline uint64_t microseconds(Clock::duration d) {
  return d.count() > 0 ? static_cast<uint64_t>(std::chrono::duration_cast<std::chrono::microseconds>(d).count()) : 0;
}
inline double milliseconds(Clock::duration d) { return std::chrono::duration<double, std::milli>(d).count(); }

/// Where a frame's time went, microseconds.
struct Stages {
  uint64_t camera_wait = 0;  ///< arrival of its camera to the start of the tick
  uint64_t tick = 0;
  uint64_t mailbox = 0;
  uint64_t encode = 0;
  uint64_t queue = 0;  ///< encoded, until its write began
  uint64_t write = 0;  ///< of the write before this frame's
};

/// Sums over a viewer's frames, and the newest frame's own figures.
struct ViewerCounters {
  uint64_t frames = 0;
  uint64_t dropped = 0;
  uint64_t bytes = 0;
  Stages sums;
  render::FrameStats newest;
  std::vector<render::DroppedSamples> dropped_samples;  ///< of all frames rendered, by pass and cause

  /// What was dropped in a frame, whether it is sent or not.
  void countDropped(const std::vector<render::DroppedSamples>& of_frame);
  void count(const Stages& stages, uint32_t dropped_before, uint64_t size);
};

struct WorldCounters {
  uint64_t ticks = 0;
  uint64_t tick_us = 0;
};

/// From an edit's arrival to the write of the first frame that shows it. Thread-safe.
class EditLatency {
 public:
  void arrived(uint64_t seq, Clock::time_point when);
  /// A frame that shows every edit up to `applied_seq` goes out. Returns the milliseconds of those it is the first to
  /// show.
  std::vector<double> shown(uint64_t applied_seq, Clock::time_point when);
  /// Milliseconds measured since `index` (0 at first), oldest first, and the index to ask with next time. The newest
  /// 256 are kept.
  std::pair<std::vector<double>, uint64_t> since(uint64_t index) const;

 private:
  mutable std::mutex mutex_;
  std::deque<std::pair<uint64_t, Clock::time_point>> waiting_;
  std::deque<double> measured_;
  uint64_t measured_count_ = 0;
};

/// Resident memory of this process in bytes; 0 where the system does not say.
uint64_t residentBytes();

}  // namespace helio::telemetry
