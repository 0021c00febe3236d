// What the two steps of the pass `occlusion` share. Ambient occlusion is one number a pixel: how much of the sky is seen.
#ifndef HELIO_OCCLUSION_GLSL
#define HELIO_OCCLUSION_GLSL
#include "svgf/signals.glsl"

struct OpenSky {
  float share, ticks;
};
OpenSky readOpenSky(uint image, ivec2 pixel) {
  const vec2 texel = imageLoad(images_rg8[image], pixel).xy;
  return OpenSky(texel.x, texel.y * float(kMostTicksOfLight));
}

#endif
