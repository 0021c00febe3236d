// Light path guided culling: what a world may choose, and what a tick came to.
#pragma once

#include <cstdint>

namespace helio::accel {

/// How rays go through the boxes that stand for what is culled. `closest_hit`: the box ends the ray, which is traced on
/// behind it. `any_hit`: a shader takes down the nearest boxes and lets the ray through, within one traversal.
enum class BoxHits : uint32_t { closest_hit, any_hit };

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
  /// Latency mitigation: what comes into a viewer's sight is in the TLAS in the same tick, for its hits to confirm.
  bool mitigation = true;
  float sight_radius = 32.0f;    ///< metres: the margin of a viewer's frustum; [0, 1e6]
  uint32_t sight_blocks = 1024;  ///< blocks of 64 instances that a tick may look into; [1, 1,000,000]
  /// Of a picture with more paths than this only so many count, in tiles and in turn; [1024, 16,777,216].
  uint32_t counted_paths = 262'144;
  /// Ticks that hits are averaged over, [1, 64]; fewer behind a camera cut, up to 64 where nothing moves.
  uint32_t smoothing = 16;
  BoxHits box_hits = BoxHits::closest_hit;
  /// The paper's rules to the letter: no smoothing, no n_a and n_d for instances, no damping of cycles.
  bool literal = false;
};

/// Of one tick. Instances that are too large for a hitbox are always active.
struct LipacFigures {
  uint32_t inactive = 0, omitted = 0, requested = 0, active = 0;  ///< instances by state
  uint32_t active_hitboxes = 0;
  uint32_t boxes = 0;     ///< hitboxes in the TLAS, for what is inactive in them
  uint32_t entries = 0;   ///< of the TLAS, boxes included
  uint32_t dropped = 0;   ///< found no room in it
  uint32_t changes = 0;   ///< instances whose state changed
  uint64_t box_hits = 0;  ///< of rays that met a hitbox, in hits of 1920 x 1080 paths
  uint32_t cycles = 0;    ///< hitboxes, and instances with a BLAS of their own, that went back
  uint32_t wanted = 0;    ///< BLASes asked for
  uint32_t served = 0;
  uint32_t left_over = 0;  ///< by the budget: the GPU asks again
  // Latency mitigation.
  uint32_t opened = 0;   ///< hitboxes that became active because something in them came into sight
  uint32_t shown = 0;    ///< instances that got a BLAS of their own for the same reason
  uint32_t unshown = 0;  ///< that the budget left out: the next tick tries again
  // CPU, milliseconds: the commands of the GPU, what comes into sight, the tables that the GPU reads.
  double commands_ms = 0.0, sight_ms = 0.0, upload_ms = 0.0;
  uint64_t cpu_visits = 0;  ///< instances, and blocks of 64, that the CPU looked at in this tick, for culling
};

}  // namespace helio::accel
