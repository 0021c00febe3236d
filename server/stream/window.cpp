#include "stream/window.h"

#include <algorithm>
#include <cmath>

namespace helio::stream {
namespace {

double seconds(AckWindow::Clock::duration d) { return std::chrono::duration<double>(d).count(); }

}  // namespace

void AckWindow::configure(uint32_t fps, Clock::duration max_latency) {
  fps_ = fps;
  max_latency_ = max_latency;
}

void AckWindow::sent(uint64_t id, Clock::time_point now) { flying_.push_back({id, now}); }

bool AckWindow::acknowledged(uint64_t id, Clock::duration held, Clock::time_point now) {
  const auto frame = std::find_if(flying_.begin(), flying_.end(), [&](const Flying& f) { return f.id == id; });
  if (frame == flying_.end()) return false;
  const Clock::duration round_trip = std::max(now - frame->sent - held, Clock::duration::zero());
  smallest_ = smallest_ ? std::min(*smallest_, round_trip) : round_trip;
  last_ = now;
  last_round_trip_ = round_trip;
  flying_.erase(flying_.begin(), frame + 1);
  return true;
}

AckWindow::Clock::duration AckWindow::silence(Clock::time_point now) const {
  return flying_.empty() ? Clock::duration::zero() : now - flying_.front().sent;
}

bool AckWindow::open(Clock::time_point now) const {
  if (flying_.empty()) return true;
  return flying_.size() < size() && now - flying_.front().sent <= max_latency_;
}

uint32_t AckWindow::size() const {
  const double in_flight = std::ceil(fps_ * seconds(smallest_.value_or(Clock::duration::zero())));
  const double bound = std::max(1.0, std::floor(fps_ * seconds(max_latency_)));
  return static_cast<uint32_t>(std::min(in_flight + 2, bound));
}

}  // namespace helio::stream
