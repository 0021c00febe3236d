#version 460
#extension GL_GOOGLE_include_directive : require
// SVGF's estimate of variance [Schied et al. 2017, section 4.2]: over time where there are ticks enough, over 7 x 7 neighbours of
// like geometry where there are not. This tick's moments, which have waited, take the place of those of the tick before.

const int kGroup = 16, kMargin = 3, kStride = 1;
layout(local_size_x = kGroup, local_size_y = kGroup) in;

// The next tick goes on from the mean, before anything filters it.
layout(constant_id = 0) const bool kKeepsMean = false;

#include "svgf/taps.glsl"

// Mean light and standard deviation of its luminance over the neighbours and the pixel's own, `own`.
LobeLight overNeighbours(vec3 own[kSignals], int here, float gradient, vec2 samples) {
  const vec4 surface = unpackHalf4(surfaces[here]);
  const float depth = depths[here];
  CutMean means[kSignals] = CutMean[](emptyMean(), emptyMean());
  for (uint s = 0u; s < kSignals; ++s) addTo(means[s], own[s], 1.0);
  for (int y = -kMargin; y <= kMargin; ++y)
    for (int x = -kMargin; x <= kMargin; ++x) {
      const int there = here + y * kColumns + x;
      const Likeness alike = likeness(surface, depth, there, gradient, length(vec2(x, y)));
      if (there == here || !counts(alike)) continue;
      const float w = alike.normals * exp(-alike.apart);
      for (uint s = 0u; s < kSignals; ++s) addTo(means[s], unpackHalf4(lights[s][there]).rgb, w);
    }
  LobeLight result;
  for (uint s = 0u; s < kSignals; ++s) {
    CutMean m = means[s];
    finish(m, samples[s]);
    result.rgb[s] = m.light / m.weight;
    // The neighbours' means vary as this one does. The first ticks' estimate is widened, lest the filter trust it.
    const float mean = m.first / m.weight, variance = max(m.second / m.weight - mean * mean, 0.0);
    result.deviation[s] = sqrt(variance * kEnoughTicks / max(samples[s], 1.0));
  }
  return result;
}

void withoutFireflies(inout vec3 light[kSignals], ivec2 pixel, int here, float gradient) {
  const vec4 surface = unpackHalf4(surfaces[here]);
  const float depth = depths[here];
  Surroundings around = noSurroundings();
  for (int i = 0; i < 9; ++i) {
    const ivec2 offset = 2 * (ivec2(i % 3, i / 3) - 1), away = tapAround(pixel, offset) - pixel;
    const int there = here + away.y * kColumns + away.x;
    if (i == 4 || depths[there] == 0.0) continue;
    const Likeness alike = likeness(surface, depth, there, gradient, length(vec2(offset)));
    addTo(around, luminancesOf(there), alike.normals * exp(-alike.apart));
  }
  cutFireflies(light, around, kEnoughTicks);
}

void main() {
  const ivec2 point = ivec2(gl_LocalInvocationID.xy), pixel = pixelOf(point);
  fetchTaps();
  if (!inPicture(pixel)) return;
  const int here = tapOf(point);
  const bool seen = depths[here] != 0.0;
  const uvec2 moments = imageLoad(images_rg32ui[history.spare], pixel).xy;
  const vec2 samples = imageLoad(images_rg16f[history.spare_deviation], pixel).xy;
  imageStore(images_rg32ui[history.moments], pixel, uvec4(moments, 0u, 0u));
  keepTicks(pixel, samples);
  LobeLight light = readLight(filter_.source, filter_.source_deviation, pixel);
  const vec4 motion = imageLoad(images_rgba16f[history.motion], pixel);
  if (seen) withoutFireflies(light.rgb, pixel, here, motion.w);
  if (kKeepsMean) imageStore(images_rg32ui[history.filtered], pixel, uvec4(packLight(light.rgb[0], 0.5), packLight(light.rgb[1], 0.5), 0u, 0u));
  if (seen && min(samples.x, samples.y) < kEnoughTicks) {
    const LobeLight around = overNeighbours(light.rgb, here, motion.w, samples);
    for (uint s = 0u; s < kSignals; ++s) {
      if (samples[s] >= kEnoughTicks) continue;
      light.rgb[s] = around.rgb[s];
      light.deviation[s] = around.deviation[s];
    }
  }
  writeLight(filter_.target, filter_.target_deviation, pixel, light, 0.5);
}
