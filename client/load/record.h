// What one client has measured. Filled by its threads, read when they have ended (progress may look in between).
#pragma once

#include <array>
#include <chrono>
#include <mutex>
#include <string>
#include <vector>

#include "load/metrics.h"

namespace helio::load {

using Clock = std::chrono::steady_clock;

inline double secondsBetween(Clock::time_point a, Clock::time_point b) {
  return std::chrono::duration<double>(b - a).count();
}
inline Clock::duration durationOf(double seconds) {
  return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
}

struct Sample {
  float t = 0;  ///< seconds since the run's start, when the value was known
  float value = 0;
};

struct Mishap {
  double t = 0;
  std::string what;
};

struct Counts {
  uint64_t frames = 0, bytes = 0, dropped = 0;
  uint64_t steps = 0, failed_steps = 0, ended_streams = 0, wrong_pictures = 0, acknowledged_edits = 0;
};

class Record {
 public:
  explicit Record(Clock::time_point start) : start_(start) {}

  /// Notes an event of `series` that ends now and began at `since`.
  void took(Series series, Clock::time_point since) {
    const auto now = Clock::now();
    add(series, now, secondsBetween(since, now) * 1000);
  }
  void add(Series series, Clock::time_point at, double ms) {
    const std::lock_guard lock(mutex_);
    series_[series].push_back({since(at), static_cast<float>(ms)});
  }
  void frame(Clock::time_point at, size_t bytes, uint32_t dropped) {
    const std::lock_guard lock(mutex_);
    ++counts_.frames;
    counts_.bytes += bytes;
    counts_.dropped += dropped;
    frames_.push_back({since(at), static_cast<float>(bytes)});
  }
  void step() {
    const std::lock_guard lock(mutex_);
    ++counts_.steps;
  }
  void editAcknowledged() {
    const std::lock_guard lock(mutex_);
    ++counts_.acknowledged_edits;
  }
  void stepFailed(const std::string& what) { mishap(counts_.failed_steps, what); }
  void streamEnded(const std::string& what) { mishap(counts_.ended_streams, "the stream ended: " + what); }
  void wrongPicture(const std::string& what) { mishap(counts_.wrong_pictures, "a picture is wrong: " + what); }
  /// Seconds in which a stream was open, after the warm-up.
  void watched(double seconds) {
    const std::lock_guard lock(mutex_);
    watched_ += seconds;
  }

  Counts counts() const {
    const std::lock_guard lock(mutex_);
    return counts_;
  }
  // When its threads have ended.
  const std::vector<Sample>& series(Series series) const { return series_[series]; }
  const std::vector<Sample>& frames() const { return frames_; }  ///< bytes of each
  const std::vector<Mishap>& mishaps() const { return mishaps_; }
  double watched() const { return watched_; }

 private:
  static constexpr size_t kMishapsKept = 20;

  float since(Clock::time_point at) const { return static_cast<float>(secondsBetween(start_, at)); }
  void mishap(uint64_t& counter, const std::string& what) {
    const std::lock_guard lock(mutex_);
    ++counter;
    if (mishaps_.size() < kMishapsKept) mishaps_.push_back({secondsBetween(start_, Clock::now()), what});
  }

  const Clock::time_point start_;
  mutable std::mutex mutex_;
  std::array<std::vector<Sample>, kSeriesCount> series_;
  std::vector<Sample> frames_;
  Counts counts_;
  std::vector<Mishap> mishaps_;
  double watched_ = 0;
};

}  // namespace helio::load
