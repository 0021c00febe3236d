#include "accel/viewer_quorum.h"

namespace helio::accel {

bool ViewerQuorum::counts(uint64_t viewer, uint64_t tick) {
  Viewer& v = viewers_[viewer];
  v.seen = true;
  v.tick = tick;
  if (v.counted) return false;
  v.counted = true;
  return true;
}

bool ViewerQuorum::complete(uint64_t tick) {
  bool any = false;
  for (const auto& [handle, v] : viewers_) {
    const bool idle = !v.seen || tick - v.tick >= kIdleAfter;
    if (!v.counted && !idle) return false;
    any |= v.counted;
  }
  if (!any) return false;
  for (auto& [handle, v] : viewers_) v.counted = false;
  return true;
}

}  // namespace helio::accel
