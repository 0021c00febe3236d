// Rays from the camera: a pinhole, or a thin lens that sees one plane sharply [Cook et al. 1984, section 4.3].
#ifndef HELIO_CAMERA_GLSL
#define HELIO_CAMERA_GLSL
#include "lib/effects.glsl"
#include "lib/math.glsl"
#include "lib/sampler.glsl"

// A path's first decisions.
const uint kPixelPosition = 0u, kLensPoint = 1u;

// Where in the pixel this sample looks, in [0, 1)^2: everywhere alike, or each pixel by itself.
vec2 pixelPosition(uvec2 pixel) { return push.jitter.x < 0.0 ? pathSample2(pixel, kPixelPosition) : push.jitter; }

struct CameraRay {
  vec3 origin, direction;
};

// The pixel's ray through the middle of the lens: all of it meet in one point of the plane that is sharp.
vec3 pinholeRay(uvec2 pixel) {
  const vec2 ndc = 2.0 * (vec2(pixel) + pixelPosition(pixel)) / vec2(frame.width, frame.height) - 1.0;
  return frame.forward + frame.tangent * (ndc.x * frame.aspect * frame.right - ndc.y * frame.up);
}

CameraRay cameraRay(uvec2 pixel) {
  const vec3 middle = pinholeRay(pixel);
  if (!kLens || frame.lens_radius == 0.0) return CameraRay(frame.position, normalize(middle));
  const vec2 u = pathSample2(pixel, kLensPoint);
  const float r = frame.lens_radius * sqrt(u.x), phi = 2.0 * kPi * u.y;
  const vec3 on_lens = r * (cos(phi) * frame.right + sin(phi) * frame.up);
  return CameraRay(frame.position + on_lens, normalize(frame.focus * middle - on_lens));
}

vec3 cameraDirection(uvec2 pixel) { return cameraRay(pixel).direction; }

#endif
