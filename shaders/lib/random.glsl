// Random numbers: a pure function of (pixel, sample, dimension). PCG [O'Neill 2014; Jarzynski and Olano 2020].
#ifndef HELIO_RANDOM_GLSL
#define HELIO_RANDOM_GLSL

uvec4 pcg4d(uvec4 v) {
  v = v * 1664525u + 1013904223u;
  v.x += v.y * v.w;
  v.y += v.z * v.x;
  v.z += v.x * v.y;
  v.w += v.y * v.z;
  v ^= v >> 16;
  v.x += v.y * v.w;
  v.y += v.z * v.x;
  v.z += v.x * v.y;
  v.w += v.y * v.z;
  return v;
}

// Four numbers in [0, 1): 24 bits, so that 1 is never reached.
vec4 randomAt(uvec2 pixel, uint sample_index, uint dimension) {
  return vec4(pcg4d(uvec4(pixel, sample_index, dimension)) >> 8) * (1.0 / 16777216.0);
}

#endif
