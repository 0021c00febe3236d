// Light path guided culling: what a world may choose, and what a tick came to.
#pragma once

#include <cstdint>

namespace helio::accel {

/// Thresholds are hits a tick of 1920 x 1080 paths, whatever a viewer's size and samples are [Kelling et al. 2024,
/// §3.5]; [2, kHighestThreshold], or kUnreachable.
struct LipacSettings {
  static constexpr float kHighestThreshold = 30'000.0f;
  static constexpr float kUnreachable = 1e30f;

  float box_activate = 1000.0f;   ///< theta_a: a hitbox's instances enter
  float box_deactivate = 100.0f;  ///< theta_d: and leave again
  float own_activate = 1000.0f;   ///< sigma_a: an instance gets a BLAS of its own
  float own_deactivate = 100.0f;  ///< sigma_o: and loses it
  uint32_t frames_above = 4;      ///< n_a, [1, 7]
  uint32_t frames_below = 15;     ///< n_d, [1, 15]
  /// The paper's rules to the letter: no smoothing, no n_a and n_d for instances, no damping of cycles.
  bool literal = false;
};

/// Of one tick. Instances that are too large for a hitbox are always active.
struct LipacFigures {
  uint32_t inactive = 0, omitted = 0, requested = 0, active = 0;  ///< instances by state
  uint32_t active_hitboxes = 0;
  uint32_t boxes = 0;    ///< hitboxes in the TLAS, for what is inactive in them
  uint32_t entries = 0;  ///< of the TLAS, boxes included
  uint32_t dropped = 0;  ///< found no room in it
  uint32_t changes = 0;  ///< instances whose state changed
  uint32_t cycles = 0;   ///< hitboxes, and instances with a BLAS of their own, that went back
  uint32_t wanted = 0;   ///< BLASes asked for
  uint32_t served = 0;
  uint32_t left_over = 0;   ///< by the budget: the GPU asks again
  uint64_t cpu_visits = 0;  ///< instances that the CPU looked at in this tick, for culling
};

}  // namespace helio::accel
