#include "telemetry/statistics.h"

#include <unistd.h>

#include <algorithm>
#include <fstream>

namespace helio::telemetry {
namespace {

// Nobody may be watching for hours: the oldest edits are forgotten, they would only tell how long nobody watched.
constexpr size_t kMostWaiting = 1024;
constexpr size_t kMostMeasured = 256;

}  // namespace

void ViewerCounters::count(const Stages& stages, uint32_t dropped_before, uint64_t size) {
  ++frames;
  dropped += dropped_before;
  bytes += size;
  sums.camera_wait += stages.camera_wait;
  sums.tick += stages.tick;
  sums.mailbox += stages.mailbox;
  sums.encode += stages.encode;
  sums.queue += stages.queue;
  sums.write += stages.write;
}

void ViewerCounters::countDropped(const std::vector<render::DroppedSamples>& of_frame) {
  for (const render::DroppedSamples& more : of_frame) {
    const auto known = std::find_if(dropped_samples.begin(), dropped_samples.end(), [&](const auto& kind) {
      return kind.pass == more.pass && kind.cause == more.cause;
    });
    if (known == dropped_samples.end()) dropped_samples.push_back(more);
    else known->samples += more.samples;
  }
}

void EditLatency::arrived(uint64_t seq, Clock::time_point when) {
  std::lock_guard lock(mutex_);
  waiting_.emplace_back(seq, when);
  if (waiting_.size() > kMostWaiting) waiting_.pop_front();
}

std::vector<double> EditLatency::shown(uint64_t applied_seq, Clock::time_point when) {
  std::lock_guard lock(mutex_);
  std::vector<double> now;
  while (!waiting_.empty() && waiting_.front().first <= applied_seq) {
    now.push_back(milliseconds(when - waiting_.front().second));
    measured_.push_back(now.back());
    if (measured_.size() > kMostMeasured) measured_.pop_front();
    ++measured_count_;
    waiting_.pop_front();
  }
  return now;
}

std::pair<std::vector<double>, uint64_t> EditLatency::since(uint64_t index) const {
  std::lock_guard lock(mutex_);
  const size_t fresh = std::min<uint64_t>(measured_count_ - std::min(index, measured_count_), measured_.size());
  return {std::vector<double>(measured_.end() - static_cast<std::ptrdiff_t>(fresh), measured_.end()), measured_count_};
}

uint64_t residentBytes() {
  std::ifstream statm("/proc/self/statm");
  uint64_t total = 0, resident = 0;
  if (!(statm >> total >> resident)) return 0;
  return resident * static_cast<uint64_t>(sysconf(_SC_PAGESIZE));
}

}  // namespace helio::telemetry
