// How many edits a second a world takes: a token bucket.
#pragma once

#include <chrono>
#include <cstdint>
#include <mutex>
#include <vector>

#include "telemetry/statistics.h"
#include "world/world.h"

namespace helio::service {

/// What a request costs: one for each edit and each placement of a build.
uint64_t sizeOf(const std::vector<world::Edit>& edits);

/// A bucket that holds one second's worth and fills at `per_second`. Who comes when it is full always gets what one
/// call may hold: a call is taken while there is anything in the bucket, and what it takes beyond that has to be filled
/// up again before the next is. Thread-safe.
class EditRate {
 public:
  using Clock = telemetry::Clock;

  explicit EditRate(uint32_t per_second) : per_second_(per_second), level_(per_second) {}

  /// Zero: taken. Otherwise nothing is taken, and the caller shall come again after so long.
  std::chrono::milliseconds take(uint64_t edits, Clock::time_point now);

 private:
  const double per_second_;
  std::mutex mutex_;
  double level_;
  Clock::time_point filled_{};
};

}  // namespace helio::service
