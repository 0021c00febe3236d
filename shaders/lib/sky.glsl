// Light from infinity: the sky's gradient and the sun's disc.
#ifndef HELIO_SKY_GLSL
#define HELIO_SKY_GLSL
#include "lib/effects.glsl"
#include "lib/math.glsl"
#include "lib/tables.glsl"

vec3 skyRadiance(vec3 direction) {
  // A unit vector in floats may be a little longer: without the clamp a black end of the gradient turns negative.
  return kSkyGradient ? mix(frame.sky_ground, frame.sky_zenith, clamp(0.5 + 0.5 * direction.y, 0.0, 1.0)) : frame.sky_zenith;
}

bool inSunDisc(vec3 direction) {
  // 1 - cos = |a - b|^2 / 2 keeps its digits for a disc of half a degree, where 1 - dot() has none left.
  const vec3 difference = direction - frame.sun_to;
  return 0.5 * dot(difference, difference) < frame.sun_one_minus_cos;
}

// Density of sampleSun, per steradian.
float sunPdf() { return 1.0 / (2.0 * kPi * frame.sun_one_minus_cos); }

// Uniform direction in the disc.
vec3 sampleSun(vec2 u) {
  const float one_minus_cos = u.x * frame.sun_one_minus_cos;
  const float sin_theta = sqrt(max(0.0, one_minus_cos * (2.0 - one_minus_cos)));
  const float phi = 2.0 * kPi * u.y;
  return normalize(basis(frame.sun_to) * vec3(sin_theta * cos(phi), sin_theta * sin(phi), 1.0 - one_minus_cos));
}

#endif
