#version 460
#extension GL_GOOGLE_include_directive : require
// One iteration of SVGF's edge-avoiding a-trous wavelet filter [Schied et al. 2017, section 4.3 and 4.4; Dammertz et al. 2010]:
// 5 x 5 taps `stride` pixels apart. Edges are found in depth, normals, and in luminance as far as its variance lets them be seen.
// The last iteration makes the picture: albedos and emission come back.
#include "lib/random.glsl"
#include "svgf/filter.glsl"
#include "svgf/picture.glsl"

const int kGroup = 8, kTile = kGroup + 2;
layout(local_size_x = kGroup, local_size_y = kGroup) in;
layout(constant_id = 0) const bool kLast = false;

const float kKernel[3] = float[](3.0 / 8.0, 1.0 / 4.0, 1.0 / 16.0);  // B3 spline

shared vec2 variances[kTile * kTile];  // of the group's pixels and one around them; negative beyond the picture

void fetchVariances() {
  const ivec2 corner = ivec2(gl_WorkGroupID.xy) * kGroup - 1;
  for (int i = int(gl_LocalInvocationIndex); i < kTile * kTile; i += kGroup * kGroup) {
    const ivec2 at = corner + ivec2(i % kTile, i / kTile);
    const vec2 deviation = inPicture(at) ? imageLoad(images_rg16f[filter_.source_deviation], at).xy : vec2(0.0);
    variances[i] = inPicture(at) ? deviation * deviation : vec2(-1.0);
  }
  barrier();
}

// Standard deviation, smoothed by a 3 x 3 Gaussian: single estimates are too noisy to steer by.
vec2 smoothDeviation() {
  const ivec2 middle = ivec2(gl_LocalInvocationID.xy) + 1;
  vec2 variance = vec2(0.0);
  float sum = 0.0;
  for (int y = -1; y <= 1; ++y)
    for (int x = -1; x <= 1; ++x) {
      const vec2 there = variances[(middle.y + y) * kTile + middle.x + x];
      const float w = there.x < 0.0 ? 0.0 : (x == 0 ? 0.5 : 0.25) * (y == 0 ? 0.5 : 0.25);
      variance += w * there;
      sum += w;
    }
  return sqrt(variance / sum);
}

// Taps that weigh less than this for their surface alone are left out, before their light is fetched.
const float kLeastAlike = 1e-3, kMostApart = 7.0;  // exp(-7) = 1e-3

LobeLight filteredLight(ivec2 pixel, SurfaceTexel here, LobeLight own) {
  const float gradient = imageLoad(images_rgba16f[history.motion], pixel).w, samples = gatheredTicks(pixel).x;
  const vec2 per_luminance = 1.0 / (kSigmaLuminance * smoothDeviation() + 1e-5);
  const float per_sunlit = 1.0 / sunlitTolerance(samples);
  const vec2 l = vec2(luminance(own.rgb[0]), luminance(own.rgb[1]));
  vec2 sum = vec2(kKernel[0] * kKernel[0]);
  vec2 variance = sum * sum * own.deviation * own.deviation;
  vec3 light[kSignals] = vec3[](sum.x * own.rgb[0], sum.y * own.rgb[1]);
  for (int y = -2; y <= 2; ++y)
    for (int x = -2; x <= 2; ++x) {
      const ivec2 at = pixel + ivec2(x, y) * int(filter_.stride);
      if ((x == 0 && y == 0) || !inPicture(at)) continue;
      const SurfaceTexel there = readSurface(history.surface, at);
      // As geometryWeight() and sunlitWeight(); of a product of exponentials, the exponents' sum.
      if (there.depth == 0.0 || there.mirrored != here.mirrored) continue;
      const float alike = normalWeight(here, there);
      const float tolerance = depthTolerance(here.depth, gradient, length(vec2(x, y)) * float(filter_.stride));
      const float apart = abs(here.depth - there.depth) / tolerance + abs(here.sunlit - there.sunlit) * per_sunlit;
      if (alike < kLeastAlike || apart > kMostApart) continue;
      const LobeLight tap = readLight(filter_.source, filter_.source_deviation, at);
      const vec2 difference = abs(vec2(luminance(tap.rgb[0]), luminance(tap.rgb[1])) - l) * per_luminance;
      const vec2 w = kKernel[abs(x)] * kKernel[abs(y)] * alike * exp(-(apart + difference));
      for (uint s = 0u; s < kSignals; ++s) light[s] += w[s] * tap.rgb[s];
      variance += w * w * tap.deviation * tap.deviation;
      sum += w;
    }
  return LobeLight(vec3[](light[0] / sum.x, light[1] / sum.y), sqrt(variance) / sum);
}

void main() {
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  fetchVariances();
  if (!inPicture(pixel)) return;
  const SurfaceTexel here = readSurface(history.surface, pixel);
  LobeLight light = readLight(filter_.source, filter_.source_deviation, pixel);
  if (here.depth > 0.0) light = filteredLight(pixel, here, light);
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
