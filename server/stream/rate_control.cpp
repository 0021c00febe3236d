#include "stream/rate_control.h"

#include <algorithm>
#include <cmath>

namespace helio::stream {
namespace {

double seconds(RateControl::Clock::duration d) { return std::chrono::duration<double>(d).count(); }

// The size of a JPEG about doubles over so many steps of quality between 25 and 95: what the library's tables do to
// noisy and to plain pictures alike, within a third.
constexpr double kStepsPerDoubling = 24.0;
constexpr double kSmoothing = 0.3;  // of the size: pictures of a moving camera change within a few frames
// A queue that holds a quarter of the latency allowed is one; a scheduler's hiccup is not.
constexpr double kQueueShare = 0.25, kHiccup = 0.020;
constexpr double kBackOff = 0.85, kGrowth = 1.08;  // a round trip
constexpr double kLeastRate = 4'000;               // bytes a second: a modem's; below, nothing would ever come

}  // namespace

void RateControl::configure(const Wishes& wishes) {
  wishes_ = wishes;
  next_ = {};
}

std::optional<double> RateControl::rate() const {
  const double wished = wishes_.max_kbps * 1000.0 / 8.0;
  if (wishes_.max_kbps == 0) return rate_;
  return rate_ ? std::min(*rate_, wished) : wished;
}

int RateControl::quality(bool still) const {
  const int best = still ? wishes_.still_quality : wishes_.quality;
  const auto bound = rate();
  // A still picture may take as long as latency allows: nothing that moves waits behind it.
  const double wanted_seconds =
      still ? std::max(0.5 * seconds(wishes_.max_latency), 1.0 / wishes_.max_fps) : 1.0 / wishes_.max_fps;
  if (!bound || !log_size_) return still && !log_size_ ? wishes_.quality : best;
  const double fits = std::log2(std::max(1.0, *bound * wanted_seconds));
  const double quality = 50.0 + kStepsPerDoubling * (fits - *log_size_);
  const int worst = std::min(kWorstQuality, best);
  return static_cast<int>(std::clamp(quality, static_cast<double>(worst), static_cast<double>(best)));
}

void RateControl::learnSize(uint64_t bytes, int quality) {
  const double log_size =
      std::log2(std::max<double>(1.0, static_cast<double>(bytes))) - (quality - 50) / kStepsPerDoubling;
  log_size_ = log_size_ ? *log_size_ + kSmoothing * (log_size - *log_size_) : log_size;
}

void RateControl::sent(uint64_t id, uint64_t bytes, int quality, Clock::time_point now) {
  flying_.push_back({id, bytes, now, delivered_});
  learnSize(bytes, quality);
  // One picture may be on its way while the one before still uses up its time: each adds its own.
  if (const auto bound = rate())
    next_ = std::max(next_, now) + std::chrono::duration_cast<Clock::duration>(
                                       std::chrono::duration<double>(static_cast<double>(bytes) / *bound));
}

void RateControl::acknowledged(uint64_t id, Clock::duration round_trip, Clock::duration smallest,
                               Clock::time_point now) {
  const auto frame = std::find_if(flying_.begin(), flying_.end(), [&](const Flying& f) { return f.id == id; });
  if (frame == flying_.end()) return;
  for (auto f = flying_.begin(); f <= frame; ++f) delivered_ += f->bytes;
  const Flying newest = *frame;
  flying_.erase(flying_.begin(), frame + 1);

  const double took = std::max(seconds(now - newest.sent), 1e-4);
  const double delivered_rate = static_cast<double>(delivered_ - newest.delivered_before) / took;
  const double queued = seconds(round_trip - smallest);
  const bool queueing = queued > std::max(kQueueShare * seconds(wishes_.max_latency), kHiccup);
  if (now - last_change_ <
      std::max(round_trip, std::chrono::duration_cast<Clock::duration>(std::chrono::milliseconds(50))))
    return;  // what was changed last cannot be seen yet
  if (queueing) {
    rate_ = std::max(kLeastRate, kBackOff * std::min(delivered_rate, rate_.value_or(delivered_rate)));
    last_change_ = now;
  } else if (rate_) {
    rate_ = *rate_ * kGrowth;
    last_change_ = now;
    // Far beyond what is asked for there is nothing left to bound.
    const double most =
        std::exp2(log_size_.value_or(0) + (wishes_.still_quality - 50) / kStepsPerDoubling) * wishes_.max_fps;
    if (log_size_ && *rate_ > 4 * most) rate_.reset();
  }
}

}  // namespace helio::stream
