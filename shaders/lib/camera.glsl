#ifndef HELIO_CAMERA_GLSL
#define HELIO_CAMERA_GLSL
#include "lib/tables.glsl"

// Direction through a point of the pixel; `jitter` in [0, 1)^2 (0.5, 0.5 is the centre).
vec3 cameraDirection(uvec2 pixel, vec2 jitter) {
  const vec2 ndc = 2.0 * (vec2(pixel) + jitter) / vec2(frame.width, frame.height) - 1.0;
  return normalize(frame.forward + frame.tangent * (ndc.x * frame.aspect * frame.right - ndc.y * frame.up));
}

#endif
