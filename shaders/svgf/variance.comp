#version 460
#extension GL_GOOGLE_include_directive : require
// SVGF's estimate of variance [Schied et al. 2017, section 4.2]: over time where there are ticks enough, over 7 x 7 neighbours of
// like geometry where there are not. This tick's moments, which have waited, take the place of those of the tick before.
#include "svgf/filter.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

// The next tick goes on from the mean, before anything filters it.
layout(constant_id = 0) const bool kKeepsMean = false;

const int kRadius = 3;

// Mean light and standard deviation of its luminance over the neighbours and the pixel's own.
LobeLight overNeighbours(vec3 own[kSignals], ivec2 pixel, SurfaceTexel here, float gradient, vec2 samples) {
  CutMean means[kSignals] = CutMean[](emptyMean(), emptyMean());
  for (uint s = 0u; s < kSignals; ++s) addTo(means[s], own[s], 1.0);
  for (int y = -kRadius; y <= kRadius; ++y)
    for (int x = -kRadius; x <= kRadius; ++x) {
      const ivec2 at = pixel + ivec2(x, y);
      if (at == pixel || !inPicture(at)) continue;
      const SurfaceTexel there = readSurface(history.surface, at);
      const float w = geometryWeight(here, there, gradient, length(vec2(x, y))) * sunlitWeight(here, there, samples.x);
      const uvec2 packed_light = imageLoad(images_rg32ui[filter_.source], at).xy;
      addTo(means[0], unpackLight(packed_light.x), w);
      addTo(means[1], unpackLight(packed_light.y), w);
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

void withoutFireflies(inout vec3 light[kSignals], ivec2 pixel, SurfaceTexel here, float gradient, float samples) {
  Surroundings around = noSurroundings();
  for (int i = 0; i < 9; ++i) {
    const ivec2 offset = 2 * (ivec2(i % 3, i / 3) - 1), at = tapAround(pixel, offset);
    if (i == 4 || !inPicture(at)) continue;
    const SurfaceTexel there = readSurface(history.surface, at);
    if (there.depth == 0.0) continue;
    const float w = geometryWeight(here, there, gradient, length(vec2(offset))) * sunlitWeight(here, there, samples);
    const uvec2 packed_light = imageLoad(images_rg32ui[filter_.source], at).xy;
    addTo(around, vec2(luminance(unpackLight(packed_light.x)), luminance(unpackLight(packed_light.y))), w);
  }
  cutFireflies(light, around, kEnoughTicks);
}

void main() {
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (!inPicture(pixel)) return;
  const SurfaceTexel here = readSurface(history.surface, pixel);
  const uvec2 moments = imageLoad(images_rg32ui[history.spare], pixel).xy;
  const vec2 samples = imageLoad(images_rg16f[history.spare_deviation], pixel).xy;
  imageStore(images_rg32ui[history.moments], pixel, uvec4(moments, 0u, 0u));
  keepTicks(pixel, samples);
  LobeLight light = readLight(filter_.source, filter_.source_deviation, pixel);
  const vec4 motion = imageLoad(images_rgba16f[history.motion], pixel);
  if (here.depth > 0.0) withoutFireflies(light.rgb, pixel, here, motion.w, samples.x);
  if (kKeepsMean) imageStore(images_rg32ui[history.filtered], pixel, uvec4(packLight(light.rgb[0], 0.5), packLight(light.rgb[1], 0.5), 0u, 0u));
  if (here.depth > 0.0 && min(samples.x, samples.y) < kEnoughTicks) {
    const LobeLight around = overNeighbours(light.rgb, pixel, here, motion.w, samples);
    // What is young where nothing moves comes and goes with TAA's jitter: edges and leaves, which neighbours would blur. TAA takes their
    // mean.
    const bool jitters = motion.xy == vec2(0.0) && max(samples.x, samples.y) <= float(history.known);
    for (uint s = 0u; s < kSignals; ++s) {
      if (samples[s] >= kEnoughTicks) continue;
      if (!jitters) light.rgb[s] = around.rgb[s];
      light.deviation[s] = around.deviation[s];
    }
  }
  writeLight(filter_.target, filter_.target_deviation, pixel, light, 0.5);
}
