#ifndef HELIO_CAMERA_GLSL
#define HELIO_CAMERA_GLSL
#include "lib/sampler.glsl"

const uint kPixelPosition = 0u;  // a path's first decision

// Where in the pixel this sample looks, in [0, 1)^2: everywhere alike, or each pixel by itself.
vec2 pixelPosition(uvec2 pixel) { return push.jitter.x < 0.0 ? pathSample2(pixel, kPixelPosition) : push.jitter; }

vec3 cameraDirection(uvec2 pixel) {
  const vec2 ndc = 2.0 * (vec2(pixel) + pixelPosition(pixel)) / vec2(frame.width, frame.height) - 1.0;
  return normalize(frame.forward + frame.tangent * (ndc.x * frame.aspect * frame.right - ndc.y * frame.up));
}

#endif
