// Hashes for telling worlds apart: against accidents, not against attackers.
#pragma once

#include <bit>
#include <cstdint>

#include "world/world.h"

namespace helio::world {

/// A hash of a sequence of numbers: SplitMix64's finaliser over a running state. [Steele, Lea, Flood 2014, fig. 19]
class Hash {
 public:
  Hash& add(uint64_t value) {
    uint64_t z = state_ = (state_ ^ value) + 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    state_ = z ^ (z >> 31);
    return *this;
  }
  Hash& add(const glm::vec3& v) {
    for (int i = 0; i < 3; ++i) add(uint64_t{std::bit_cast<uint32_t>(v[i])});
    return *this;
  }
  uint64_t value() const { return state_; }

 private:
  uint64_t state_ = 0;
};

/// 0: the slot is free.
inline uint64_t hashOf(const Instance& instance) {
  if (instance.prefab == scene::kNone) return 0;
  Hash hash;
  hash.add(instance.id).add(uint64_t{instance.prefab});
  for (int column = 0; column < 4; ++column) hash.add(instance.transform[column]);
  return hash.value();
}

inline uint64_t hashOf(const scene::Environment& e) {
  return Hash()
      .add(e.sun.direction)
      .add(e.sun.irradiance)
      .add(uint64_t{std::bit_cast<uint32_t>(e.sun.angular_diameter)})
      .add(e.sky.zenith)
      .add(e.sky.ground)
      .value();
}

/// While it runs, its time is nothing that two worlds could have in common.
inline uint64_t hashOf(const Clock& c) {
  Hash hash;
  hash.add(std::bit_cast<uint64_t>(c.rate)).add(uint64_t{c.paused});
  if (c.paused) hash.add(std::bit_cast<uint64_t>(c.time));
  return hash.value();
}

}  // namespace helio::world
