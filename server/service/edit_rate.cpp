#include "service/edit_rate.h"

#include <algorithm>
#include <cmath>
#include <variant>

namespace helio::service {

uint64_t sizeOf(const std::vector<world::Edit>& edits) {
  uint64_t size = edits.size();
  for (const auto& edit : edits)
    if (const auto* build = std::get_if<world::Build>(&edit)) size += build->poses.size();
  return size;
}

std::chrono::milliseconds EditRate::take(uint64_t edits, Clock::time_point now) {
  std::lock_guard lock(mutex_);
  if (filled_ != Clock::time_point{})
    level_ = std::min(per_second_, level_ + per_second_ * std::chrono::duration<double>(now - filled_).count());
  filled_ = now;
  if (level_ <= 0)
    return std::chrono::milliseconds(std::max<int64_t>(1, std::llround(std::ceil(1000 * -level_ / per_second_))));
  level_ -= static_cast<double>(edits);
  return std::chrono::milliseconds(0);
}

}  // namespace helio::service
