// Running mean over samples in floats, m += (x - m) / n, rounded up or down by chance. Rounding to nearest drifts: after 10^6
// samples, most of them dark and a few bright, the steps are a few units in m's last place, all rounded the same way, and
// the mean was off by up to 0.2 % [Connolly, Higham and Mary 2021, Stochastic rounding]. By chance it is right on average, and
// within 10^-4 (tests/statistics/accumulation_test.cpp).
#ifndef HELIO_ACCUMULATION_GLSL
#define HELIO_ACCUMULATION_GLSL

// a + b, rounded so that its expected value is exact; `random` in [0, 1).
float addRoundedByChance(float a, float b, float random) {
  precise const float sum = a + b;
  if (!(sum > 0.0)) return sum;
  // What the rounding to nearest left out, exactly [Knuth, The Art of Computer Programming 2, 4.2.2].
  precise const float b_kept = sum - a;
  precise const float left_out = (a - (sum - b_kept)) + (b - b_kept);
  const float neighbour = uintBitsToFloat(floatBitsToUint(sum) + (left_out < 0.0 ? 0xffffffffu : 1u));
  return random * abs(neighbour - sum) < abs(left_out) ? neighbour : sum;
}

// `mean`: rgb, and in alpha the number of samples behind it; counts exactly up to 2^24.
vec4 runningMean(vec4 mean, vec3 value, vec3 random) {
  mean.a += 1.0;
  const vec3 step_ = (value - mean.rgb) / mean.a;
  for (int c = 0; c < 3; ++c) mean[c] = addRoundedByChance(mean[c], step_[c], random[c]);
  return mean;
}

#endif
