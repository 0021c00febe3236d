// How long the history is that a denoiser will find for a pixel: it looks where svgf/temporal.comp and reblur/temporal.comp look.
#ifndef HELIO_EXTRA_SAMPLES_YOUNG_GLSL
#define HELIO_EXTRA_SAMPLES_YOUNG_GLSL
#include "svgf/signals.glsl"

const float kLeastWeight = 0.01;  // of the bilinear taps: with less, they look around

void addTicks(inout vec2 sum, ivec2 texel, SurfaceTexel here, float depth, float gradient, float weight, bool beside) {
  if (weight <= 0.0 || !inPicture(texel)) return;
  const SurfaceTexel there = readSurface(history.previous_surface, texel);
  if (!continuesSurface(there, here, depth, gradient) || (beside && !sameSun(there, here))) return;
  sum += weight * vec2(gatheredTicks(texel).x, 1.0);  // smooth lobes forget on purpose, so the diffuse one tells
}

// Ticks; nobody gathers any without a denoiser.
float gatheredBefore(ivec2 pixel, SurfaceTexel here) {
  if (history.known == 0u || history.samples == 0u) return 0.0;
  const vec4 motion = imageLoad(images_rgba16f[history.motion], pixel);
  const vec2 at = vec2(pixel) + motion.xy;
  const ivec2 corner = ivec2(floor(at));
  const vec2 f = at - vec2(corner);
  const float depth = here.depth + motion.z;
  vec2 sum = vec2(0.0);
  for (int i = 0; i < 4; ++i) {
    const ivec2 offset = ivec2(i & 1, i >> 1);
    const vec2 w = mix(1.0 - f, f, vec2(offset));
    addTicks(sum, corner + offset, here, depth, motion.w, w.x * w.y, false);
  }
  if (sum.y < kLeastWeight) {
    const ivec2 nearest = ivec2(round(at));
    for (int i = 0; i < 9; ++i) addTicks(sum, nearest + ivec2(i % 3 - 1, i / 3 - 1), here, depth, motion.w, 1.0, true);
  }
  const float ticks = sum.y > 0.0 ? sum.x / sum.y : 0.0;
  // Where nothing moves, edges and leaves come and go with TAA's jitter. That is no news, and TAA takes the mean of them.
  return history.jitters == 1u && motion.xy == vec2(0.0) ? max(ticks, float(history.known)) : ticks;
}

#endif
