#version 460
#extension GL_GOOGLE_include_directive : require
// SVGF's estimate of variance [Schied et al. 2017, section 4.2]: over time where there are ticks enough, over 7 x 7 neighbours of
// like geometry where there are not.
#include "svgf/filter.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

const float kEnoughTicks = 4.0;
const int kRadius = 3;

// Mean light and standard deviation of its luminance over the neighbours.
vec4 overNeighbours(uint signal, ivec2 pixel, SurfaceTexel here, float gradient, float samples) {
  vec3 light = vec3(0.0);
  vec2 moments = vec2(0.0);
  float sum = 0.0;
  for (int y = -kRadius; y <= kRadius; ++y)
    for (int x = -kRadius; x <= kRadius; ++x) {
      const ivec2 at = pixel + ivec2(x, y);
      if (!inPicture(at)) continue;
      const SurfaceTexel there = readSurface(history.surface, at);
      const float w = x == 0 && y == 0 ? 1.0 : geometryWeight(here, there, gradient, length(vec2(x, y)));
      const vec3 c = imageLoad(images_rgba16f[filter_.source[signal]], at).rgb;
      const float l = luminance(c);
      light += w * c;
      moments += w * vec2(l, l * l);
      sum += w;
    }
  moments /= sum;
  // The neighbours' means vary as this one does. The first ticks' estimate is widened, lest the filter trust it.
  const float variance = max(0.0, moments.y - moments.x * moments.x) * kEnoughTicks / max(samples, 1.0);
  return vec4(light / sum, sqrt(variance));
}

void main() {
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (!inPicture(pixel)) return;
  const SurfaceTexel here = readSurface(history.surface, pixel);
  const vec2 samples = imageLoad(images_rg16f[history.samples], pixel).xy;
  const float gradient = imageLoad(images_rgba16f[history.motion], pixel).w;
  for (uint s = 0u; s < kSignals; ++s) {
    vec4 light = imageLoad(images_rgba16f[filter_.source[s]], pixel);
    if (here.depth > 0.0 && samples[s] < kEnoughTicks) light = overNeighbours(s, pixel, here, gradient, samples[s]);
    imageStore(images_rgba16f[filter_.target[s]], pixel, vec4(stored(light.rgb), min(light.a, kMostStored)));
  }
}
