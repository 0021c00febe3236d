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

// Density over the whole sphere in proportion to the sky's luminance.
float wholeSkyPdf(vec3 direction) {
  const float ground = luminance(frame.sky_ground), zenith = luminance(frame.sky_zenith);
  return ground + zenith > 0.0 ? luminance(skyRadiance(direction)) / (2.0 * kPi * (ground + zenith)) : 0.0;
}

// Density of sampleSky, per steradian.
float skyPdf(vec3 direction, vec3 normal) {
  const float below = dot(direction, normal);
  return below > 0.0 ? wholeSkyPdf(direction) + wholeSkyPdf(direction - 2.0 * below * normal) : 0.0;
}

// A direction above the plane of `normal`: one from the whole sky in proportion to its luminance, turned up at the plane if
// need be. u in [0, 1)^2.
vec3 sampleSky(vec2 u, vec3 normal) {
  // The luminance is linear in t = 0.5 + 0.5 y, and t of a uniform direction is uniform: invert the CDF, a quadratic.
  const float ground = luminance(frame.sky_ground), zenith = luminance(frame.sky_zenith);
  const float t = u.x * (ground + zenith) / (ground + sqrt(mix(ground * ground, zenith * zenith, u.x)));
  const float y = clamp(2.0 * t - 1.0, -1.0, 1.0), r = sqrt(1.0 - y * y), phi = 2.0 * kPi * u.y;
  const vec3 direction = vec3(r * cos(phi), y, r * sin(phi));
  const float below = dot(direction, normal);
  return below < 0.0 ? direction - 2.0 * below * normal : direction;
}

#endif
