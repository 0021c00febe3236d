#version 460
#extension GL_GOOGLE_include_directive : require
// The mean over ticks is blurred along the surface, the wider the fewer ticks it has; the sky's light by it joins the light that nothing
// filters any more.
#include "lib/technique.glsl"
#include "occlusion/occlusion.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

const int kTaps = 3;  // to each side
const float kWidest = 4.0, kRowsOfWidest = 1080.0;  // smaller pictures have smaller things

// How alike two texels' geometry is: of round surfaces too, since the sky is wide.
float smoothWeight(SurfaceTexel a, SurfaceTexel b, float gradient, float pixels) {
  if (b.depth == 0.0 || a.mirrored != b.mirrored) return 0.0;
  return pow(max(cosine(a, b), 0.0), 8.0) * exp(-abs(a.depth - b.depth) / depthTolerance(a.depth, gradient, pixels));
}

void main() {
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (!inPicture(pixel)) return;
  const SurfaceTexel here = readSurface(history.surface, pixel);
  if (here.depth == 0.0) return;
  const float gradient = imageLoad(images_rgba16f[history.motion], pixel).w;
  // Pixels between taps: a mean of n samples needs an n-th of the neighbours.
  const float ticks = max(readOpenSky(history.open_sky, pixel).ticks, 1.0);
  const int stride = int(max(round(kWidest * sqrt(float(frame.height) / kRowsOfWidest) * inversesqrt(ticks)), 1.0));
  float sum = 0.0, weights = 0.0;
  for (int y = -kTaps; y <= kTaps; ++y)
    for (int x = -kTaps; x <= kTaps; ++x) {
      const ivec2 offset = ivec2(x, y) * stride, at = pixel + offset;
      if (!inPicture(at)) continue;
      const OpenSky there = readOpenSky(history.open_sky, at);
      const float kernel = exp(-0.12 * float(x * x + y * y));
      const float w = kernel * max(there.ticks, 1e-3) * smoothWeight(here, readSurface(history.surface, at), gradient, length(vec2(offset)));
      sum += w * there.share;
      weights += w;
    }
  const uvec2 albedos = imageLoad(images_rg32ui[history.albedos], pixel).xy;
  const float through = imageLoad(images_rg8[history.occlusion], pixel).y;
  const vec3 light = sum / weights * through * history.unit * unpackAlbedo(albedos.x) * openSky(normalOf(here));
  const vec3 emission = unpackLight(imageLoad(images_r32ui[history.emission], pixel).x);
  imageStore(images_r32ui[history.emission], pixel, uvec4(packLight(stored(emission + light))));
}
