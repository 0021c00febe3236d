// Running mean over samples, in floats: m += (x - m) / n. A step is rounded to m's last place, so each counts as long as
// it is larger than that: some millions of samples (tests/statistics/accumulation_test.cpp).
#ifndef HELIO_ACCUMULATION_GLSL
#define HELIO_ACCUMULATION_GLSL

// `mean`: rgb, and in alpha the number of samples behind it; counts exactly up to 2^24.
vec4 runningMean(vec4 mean, vec3 value) {
  mean.a += 1.0;
  mean.rgb += (value - mean.rgb) / mean.a;
  return mean;
}

#endif
