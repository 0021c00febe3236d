#version 460
#extension GL_GOOGLE_include_directive : require
// One iteration of SVGF's edge-avoiding a-trous wavelet filter [Schied et al. 2017, section 4.3 and 4.4; Dammertz et al. 2010]:
// 5 x 5 taps `stride` pixels apart. Edges are found in depth, normals, and in luminance as far as its variance lets them be seen.
// The last iteration makes the picture: albedos and emission come back.
#include "lib/random.glsl"
#include "svgf/filter.glsl"
#include "svgf/picture.glsl"

// A group works on neighbours of one of the lattices of pixels `stride` apart, so that all of its taps lie in one tile: a texel is fetched
// and unpacked for 1.6 pixels, not for 25.
const int kGroup = 16, kReach = 2, kTile = kGroup + 2 * kReach;
layout(local_size_x = kGroup, local_size_y = kGroup) in;
layout(constant_id = 0) const bool kLast = false;

shared vec4 surfaces[kTile * kTile];  // normal, depth: negative in a mirror, 0 where nothing is
shared vec4 lights[kSignals][kTile * kTile];  // and its luminance
shared vec3 spreads[kTile * kTile];   // variances; how sunlit it is

const float kKernel[3] = float[](3.0 / 8.0, 1.0 / 4.0, 1.0 / 16.0);  // B3 spline

void fetchTile(ivec2 corner) {
  for (int i = int(gl_LocalInvocationIndex); i < kTile * kTile; i += kGroup * kGroup) {
    const ivec2 at = corner + ivec2(i % kTile, i / kTile) * int(filter_.stride);
    surfaces[i] = vec4(0.0);
    if (!inPicture(at)) continue;
    const SurfaceTexel there = readSurface(history.surface, at);
    const LobeLight light = readLight(filter_.source, filter_.source_deviation, at);
    surfaces[i] = vec4(there.normal, there.mirrored ? -there.depth : there.depth);
    for (uint s = 0u; s < kSignals; ++s) lights[s][i] = vec4(light.rgb[s], luminance(light.rgb[s]));
    spreads[i] = vec3(light.deviation * light.deviation, there.sunlit);
  }
}

// Standard deviation, smoothed by a 3 x 3 Gaussian: single estimates are too noisy to steer by.
vec2 smoothDeviation(ivec2 pixel) {
  vec2 variance = vec2(0.0);
  float sum = 0.0;
  for (int y = -1; y <= 1; ++y)
    for (int x = -1; x <= 1; ++x) {
      const ivec2 at = pixel + ivec2(x, y);
      if (!inPicture(at)) continue;
      const float w = (x == 0 ? 0.5 : 0.25) * (y == 0 ? 0.5 : 0.25);
      const vec2 deviation = imageLoad(images_rg16f[filter_.source_deviation], at).xy;
      variance += w * deviation * deviation;
      sum += w;
    }
  return sqrt(variance / sum);
}

// The light of the texel in the middle of its neighbourhood, whose place in the tile is `middle`.
LobeLight filteredLight(ivec2 pixel, int middle) {
  const vec4 here = surfaces[middle];
  const float gradient = imageLoad(images_rgba16f[history.motion], pixel).w, samples = imageLoad(images_rg16f[history.samples], pixel).x;
  const vec2 per_luminance = 1.0 / (kSigmaLuminance * smoothDeviation(pixel) + 1e-5);
  const float per_sunlit = 1.0 / sunlitTolerance(samples);
  vec3 light[kSignals] = vec3[](vec3(0.0), vec3(0.0));
  vec2 variance = vec2(0.0), sum = vec2(0.0);
  for (int y = -kReach; y <= kReach; ++y)
    for (int x = -kReach; x <= kReach; ++x) {
      const int tap = middle + y * kTile + x;
      const vec4 there = surfaces[tap];
      // What lies in a mirror, or nowhere, is another surface (geometryWeight() says why).
      if (!(here.w * there.w > 0.0)) continue;
      const float pixels = length(vec2(x, y)) * float(filter_.stride), kernel = kKernel[abs(x)] * kKernel[abs(y)];
      // Of the product of all weights, the exponents' sum.
      const float apart = abs(here.w - there.w) / depthTolerance(abs(here.w), gradient, pixels) + abs(spreads[middle].z - spreads[tap].z) * per_sunlit;
      const vec2 difference = abs(vec2(lights[0][tap].w - lights[0][middle].w, lights[1][tap].w - lights[1][middle].w)) * per_luminance;
      const vec2 w = kernel * (x == 0 && y == 0 ? 1.0 : normalWeight(here.xyz, there.xyz)) * exp(-(apart + difference));
      for (uint s = 0u; s < kSignals; ++s) light[s] += w[s] * lights[s][tap].rgb;
      variance += w * w * spreads[tap].xy;
      sum += w;
    }
  return LobeLight(vec3[](light[0] / sum.x, light[1] / sum.y), sqrt(variance) / sum);
}

void main() {
  // Groups lie beside each other that have the same place in neighbouring lattices.
  const ivec2 stride = ivec2(filter_.stride), group = ivec2(gl_WorkGroupID.xy), first = group / stride * stride * kGroup + group % stride;
  const ivec2 local = ivec2(gl_LocalInvocationID.xy), pixel = first + local * stride;
  fetchTile(first - kReach * stride);
  barrier();
  if (!inPicture(pixel)) return;
  const int middle = (local.y + kReach) * kTile + local.x + kReach;
  LobeLight light;
  if (surfaces[middle].w != 0.0)
    light = filteredLight(pixel, middle);
  else
    light = readLight(filter_.source, filter_.source_deviation, pixel);
  if (!kLast) {
    writeLight(filter_.target, filter_.target_deviation, pixel, light, 0.5);
    if (filter_.keeps != 0u) {
      const float chance = randomAt(uvec2(pixel), history.tick, 1u).x;
      imageStore(images_rg32ui[history.filtered], pixel, uvec4(packLight(stored(light.rgb[0]), chance), packLight(stored(light.rgb[1]), chance), 0u, 0u));
    }
    return;
  }
  showPictureAndVariance(pixel, light);
}
