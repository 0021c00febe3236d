#version 460
#extension GL_GOOGLE_include_directive : require
// What this tick's rays found of the sky joins the mean over the ticks before, as far as the samples around say that it still holds.
#include "occlusion/occlusion.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

const float kLeastShare = 0.05;  // of a new sample in the mean
const int kWindow = 2;
const float kDeviations = 3.0;  // of the mean of the samples around, by which the history may be off
const float kEnough = 6.0;      // of them, to judge at all

OpenSky lookBack(ivec2 pixel, SurfaceTexel here, vec4 motion) {
  OpenSky sum = OpenSky(0.0, 0.0);
  if (history.known == 0u) return sum;
  const Look look = lookedAt(pixel, here, motion);
  float weights = 0.0;
  for (int i = 0; i < 4; ++i) {
    ivec2 texel;
    SurfaceTexel there;
    const float w = tapOf(look, i, here, motion.w, texel, there);
    if (w <= 0.0) continue;
    const OpenSky before = readOpenSky(history.previous_open_sky, texel);
    sum.share += w * before.share;
    sum.ticks += w * before.ticks;
    weights += w;
  }
  return weights > 0.0 ? OpenSky(sum.share / weights, sum.ticks / weights) : sum;
}

float believable(float known, ivec2 pixel, SurfaceTexel here, float gradient) {
  float sum = 0.0, weights = 0.0, squares = 0.0;
  for (int y = -kWindow; y <= kWindow; ++y)
    for (int x = -kWindow; x <= kWindow; ++x) {
      const ivec2 at = pixel + ivec2(x, y);
      if (!inPicture(at)) continue;
      const float w = geometryWeight(here, readSurface(history.surface, at), gradient, length(vec2(x, y)));
      sum += w * imageLoad(images_rg8[history.occlusion], at).x;
      weights += w;
      squares += w * w;
    }
  const float samples = weights * weights / squares, mean = sum / weights;
  if (samples < kEnough) return known;
  // A binomial mean's, as if one sample more had found half of the sky.
  const float m = (mean * samples + 0.5) / (samples + 1.0), reach = kDeviations * sqrt(m * (1.0 - m) / samples);
  return clamp(known, mean - reach, mean + reach);
}

void main() {
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (!inPicture(pixel)) return;
  const SurfaceTexel here = readSurface(history.surface, pixel);
  OpenSky now = OpenSky(0.0, 0.0);
  if (here.depth > 0.0) {
    const vec4 motion = imageLoad(images_rgba16f[history.motion], pixel);
    const bool dropped = imageLoad(images_rg16f[history.sampled_deviation], pixel).x == 0.0;
    const OpenSky before = lookBack(pixel, here, motion);
    const float found = imageLoad(images_rg8[history.occlusion], pixel).x;
    const float known = before.ticks > 0.0 ? believable(before.share, pixel, here, motion.w) : found;
    now.ticks = min(before.ticks + (dropped ? 0.0 : 1.0), float(kMostTicksOfLight));
    now.share = dropped ? known : mix(known, found, max(1.0 / max(now.ticks, 1.0), kLeastShare));
  }
  // Rounded up or down by chance: steps of a twentieth would come to rest off their goal.
  const float chance = randomAt(uvec2(pixel), history.tick, 3u).x - 0.5;
  imageStore(images_rg8[history.open_sky], pixel, vec4(now.share + chance / 255.0, now.ticks / float(kMostTicksOfLight), 0.0, 0.0));
}
