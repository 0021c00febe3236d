// The push constants of the passes that filter.
#ifndef HELIO_SVGF_FILTER_GLSL
#define HELIO_SVGF_FILTER_GLSL
#define HELIO_OWN_PUSH
#include "lib/tables.glsl"
#include "shared/filter.h"

layout(push_constant, scalar) uniform Filter { FilterConstants filter_; };
#define frame FrameRef(filter_.frame).constants

#include "svgf/signals.glsl"

// ---- Fireflies ----
// One sample in a million is a thousand times as bright as what is around it (the sun, found by chance in a window): it would stay in the
// mean for good, and no filter could take it. So a mean over four ticks or more may be so many times as bright as what is around it; a
// sample four times as much. Biased: what lights a single pixel comes out darker. Of faint light the path tracer's roulette makes
// samples of kFaint by itself, which are cut from here on only; over an albedo.
const float kMostOverSurroundings = 8.0, kLeastFirefly = 0.05;
const float kEnoughOthers = 0.5;  // weight of what is around, to judge by it
const float kEnoughTicks = 4.0;   // means of fewer are young
// Luminance that a mean over ticks may have; `around`: what is around it has.
float mostLuminance(float around, float ticks) {
  return max(kMostOverSurroundings * max(kEnoughTicks / max(ticks, 1.0), 1.0) * around, kLeastFirefly);
}

// What is two pixels off, by weight; and the brightest of it, whatever its weight.
struct Surroundings {
  vec2 luminances;  // sum
  float weight;
  vec2 brightest;  // negative: nothing is around
};
Surroundings noSurroundings() { return Surroundings(vec2(0.0), 0.0, vec2(-1.0)); }
void addTo(inout Surroundings around, vec2 luminances, float w) {
  around.luminances += w * luminances;
  around.weight += w;
  around.brightest = max(around.brightest, luminances);
}
// Beyond the border stands what is on the other side.
ivec2 tapAround(ivec2 pixel, ivec2 offset) { return inPicture(pixel + offset) ? pixel + offset : pixel - offset; }

// Surfaces like the pixel's say how bright it may be. What is too thin to have such neighbours is measured by the brightest around it.
const float kEnoughAround = 2.0;
void cutFireflies(inout vec3 light[kSignals], Surroundings around, float ticks) {
  if (around.brightest.x < 0.0) return;
  const vec2 surroundings = around.weight < kEnoughAround ? around.brightest : around.luminances / around.weight;
  for (uint s = 0u; s < kSignals; ++s) light[s] *= min(1.0, mostLuminance(surroundings[s], ticks) / max(luminance(light[s]), 1e-6));
}

// A weighted mean whose brightest part is kept apart, to be cut in the end.
struct CutMean {
  vec3 light;           // sums, without the brightest
  float first, second;  // of luminance
  float weight;
  vec3 brightest;
  float luminance_, its_weight;
};
CutMean emptyMean() { return CutMean(vec3(0.0), 0.0, 0.0, 0.0, vec3(0.0), -1.0, 0.0); }
void addBelow(inout CutMean mean, vec3 light, float l, float w) {
  mean.light += w * light;
  mean.first += w * l;
  mean.second += w * l * l;
  mean.weight += w;
}
void addTo(inout CutMean mean, vec3 light, float w) {
  const float l = luminance(light);
  if (l <= mean.luminance_) {
    addBelow(mean, light, l, w);
    return;
  }
  if (mean.its_weight > 0.0) addBelow(mean, mean.brightest, mean.luminance_, mean.its_weight);
  mean.brightest = light;
  mean.luminance_ = l;
  mean.its_weight = w;
}
void finish(inout CutMean mean, float ticks) {
  float share = 1.0;
  if (mean.weight >= kEnoughOthers) share = min(1.0, mostLuminance(mean.first / mean.weight, ticks) / max(mean.luminance_, 1e-6));
  addBelow(mean, share * mean.brightest, share * mean.luminance_, mean.its_weight);
}

#endif
