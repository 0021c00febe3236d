// Reproducible randomness: integer hashes, PCG32, value noise. The same bits on every machine, so no <random>
// distributions and no libm functions that may round differently (only +, -, *, /, sqrt and floor).
#pragma once

#include <cmath>
#include <cstdint>

#include <glm/glm.hpp>

namespace helio::scene {

/// A bijective 64-bit hash. [SplitMix64, Steele et al. 2014]
inline uint64_t hash64(uint64_t x) {
  x += 0x9e3779b97f4a7c15u;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}
inline uint64_t hash64(uint64_t a, uint64_t b) { return hash64(a ^ hash64(b)); }
inline uint64_t hash64(uint64_t seed, int64_t x, int64_t y) {
  return hash64(hash64(seed, static_cast<uint64_t>(x)), static_cast<uint64_t>(y));
}

/// [0, 1) from the hash's upper 24 bits.
inline float unitFloat(uint64_t hash) { return static_cast<float>(hash >> 40) * 0x1p-24f; }

/// PCG32 [O'Neill 2014].
class Random {
 public:
  explicit Random(uint64_t seed) : state_(hash64(seed)) { next(); }

  uint32_t next() {
    const uint64_t old = state_;
    state_ = old * 6364136223846793005u + 1442695040888963407u;
    const uint32_t xorshifted = static_cast<uint32_t>(((old >> 18) ^ old) >> 27);
    const uint32_t rotation = static_cast<uint32_t>(old >> 59);
    return (xorshifted >> rotation) | (xorshifted << ((32 - rotation) & 31));
  }
  float uniform() { return static_cast<float>(next() >> 8) * 0x1p-24f; }                              ///< [0, 1)
  float uniform(float low, float high) { return low + (high - low) * uniform(); }                     ///< [low, high)
  uint32_t below(uint32_t count) { return static_cast<uint32_t>((uint64_t{next()} * count) >> 32); }  ///< [0, count)
  bool chance(float probability) { return uniform() < probability; }

 private:
  uint64_t state_;
};

/// (cos, sin) of an angle in turns (1 = full circle), by Taylor polynomials on an eighth of a turn: error below 1e-6.
inline glm::dvec2 unitVector(double turns) {
  const double quarters = std::floor(turns * 4.0 + 0.5);
  const double x = (turns - quarters * 0.25) * 6.283185307179586;
  const double x2 = x * x;
  const double sine = x * (1.0 - x2 / 6.0 * (1.0 - x2 / 20.0 * (1.0 - x2 / 42.0 * (1.0 - x2 / 72.0))));
  const double cosine = 1.0 - x2 / 2.0 * (1.0 - x2 / 12.0 * (1.0 - x2 / 30.0 * (1.0 - x2 / 56.0)));
  switch (static_cast<int64_t>(quarters) & 3) {
    case 0:
      return {cosine, sine};
    case 1:
      return {-sine, cosine};
    case 2:
      return {-cosine, -sine};
    default:
      return {sine, -cosine};
  }
}

/// Smooth value noise in [-1, 1] with a lattice of period `period` (0: none) in both directions.
inline float valueNoise(uint64_t seed, double x, double y, int64_t period = 0) {
  const double fx = std::floor(x), fy = std::floor(y);
  const auto tx = static_cast<float>(x - fx), ty = static_cast<float>(y - fy);
  const float sx = tx * tx * tx * (tx * (tx * 6.0f - 15.0f) + 10.0f);
  const float sy = ty * ty * ty * (ty * (ty * 6.0f - 15.0f) + 10.0f);
  const auto corner = [&](int64_t dx, int64_t dy) {
    int64_t ix = static_cast<int64_t>(fx) + dx, iy = static_cast<int64_t>(fy) + dy;
    if (period > 0) {
      ix = ((ix % period) + period) % period;
      iy = ((iy % period) + period) % period;
    }
    return 2.0f * unitFloat(hash64(seed, ix, iy)) - 1.0f;
  };
  const float low = corner(0, 0) + sx * (corner(1, 0) - corner(0, 0));
  const float high = corner(0, 1) + sx * (corner(1, 1) - corner(0, 1));
  return low + sy * (high - low);
}

/// `octaves` of value noise, each at twice the frequency and half the amplitude of the one before; in [-1, 1].
inline float fractalNoise(uint64_t seed, double x, double y, int octaves, int64_t period = 0) {
  float sum = 0.0f, amplitude = 0.5f, total = 0.0f;
  for (int octave = 0; octave < octaves; ++octave) {
    sum += amplitude * valueNoise(seed + static_cast<uint64_t>(octave), x, y, period);
    total += amplitude;
    x *= 2.0;
    y *= 2.0;
    period *= 2;
    amplitude *= 0.5f;
  }
  return sum / total;
}

}  // namespace helio::scene
