// How long the history is that a denoiser will find for a pixel: it looks where svgf/temporal.comp and reblur/temporal.comp look.
#ifndef HELIO_EXTRA_SAMPLES_YOUNG_GLSL
#define HELIO_EXTRA_SAMPLES_YOUNG_GLSL
#include "svgf/signals.glsl"

const float kLeastWeight = 0.01;  // of the bilinear taps: with less, they look around

void addTicks(inout vec2 sum, ivec2 texel, float weight) {
  sum += weight * vec2(gatheredTicks(texel).x, 1.0);  // smooth lobes forget on purpose, so the diffuse one tells
}

// Ticks; nobody gathers any without a denoiser.
float gatheredBefore(ivec2 pixel, SurfaceTexel here) {
  if (history.known == 0u || history.samples == 0u) return 0.0;
  const vec4 motion = imageLoad(images_rgba16f[history.motion], pixel);
  const Look look = lookedAt(pixel, here, motion);
  vec2 sum = vec2(0.0);
  ivec2 texel;
  SurfaceTexel there;
  for (int i = 0; i < 4; ++i) {
    const float w = tapOf(look, i, here, motion.w, texel, there);
    if (w > 0.0) addTicks(sum, texel, w);
  }
  if (sum.y < kLeastWeight)
    for (int i = 0; i < 9; ++i)
      if (besideOf(look, i, here, motion.w, texel, there)) addTicks(sum, texel, 1.0);
  const float ticks = sum.y > 0.0 ? sum.x / sum.y : 0.0;
  // Where nothing moves, edges and leaves come and go with TAA's jitter. That is no news, and TAA takes the mean of them.
  return history.jitters == 1u && motion.xy == vec2(0.0) ? max(ticks, float(history.known)) : ticks;
}

#endif
