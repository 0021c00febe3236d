#version 460
#extension GL_GOOGLE_include_directive : require
// One iteration of SVGF's edge-avoiding a-trous wavelet filter [Schied et al. 2017, section 4.3 and 4.4; Dammertz et al. 2010]:
// 5 x 5 taps `stride` pixels apart. Edges are found in depth, normals, and in luminance as far as its variance lets them be seen.
// The last iteration makes the picture: albedos and emission come back.
#include "svgf/filter.glsl"

layout(local_size_x = 8, local_size_y = 8) in;
layout(constant_id = 0) const bool kLast = false;

const float kKernel[3] = float[](3.0 / 8.0, 1.0 / 4.0, 1.0 / 16.0);  // B3 spline
// Of a picture that stands still, the plain mean takes over between so many samples: in the end it is what is right.
const float kMeanFrom = 64.0, kMeanAlone = 1024.0;

// Standard deviation, smoothed by a 3 x 3 Gaussian: single estimates are too noisy to steer by.
vec2 smoothDeviation(ivec2 pixel) {
  vec2 variance = vec2(0.0);
  float sum = 0.0;
  for (int y = -1; y <= 1; ++y)
    for (int x = -1; x <= 1; ++x) {
      const ivec2 at = pixel + ivec2(x, y);
      if (!inPicture(at)) continue;
      const float w = (x == 0 ? 0.5 : 0.25) * (y == 0 ? 0.5 : 0.25);
      for (uint s = 0u; s < kSignals; ++s) {
        const float deviation = imageLoad(images_rgba16f[filter_.source[s]], at).a;
        variance[s] += w * deviation * deviation;
      }
      sum += w;
    }
  return sqrt(variance / sum);
}

void filterLight(ivec2 pixel, SurfaceTexel here, inout vec4 light[kSignals]) {
  const float gradient = imageLoad(images_rgba16f[history.motion], pixel).w;
  const vec2 tolerance = kSigmaLuminance * smoothDeviation(pixel) + 1e-5;
  const vec2 l = vec2(luminance(light[0].rgb), luminance(light[1].rgb));
  vec2 sum = vec2(kKernel[0] * kKernel[0]);
  vec2 variance = sum * sum * vec2(light[0].a * light[0].a, light[1].a * light[1].a);
  for (uint s = 0u; s < kSignals; ++s) light[s].rgb *= sum[s];
  for (int y = -2; y <= 2; ++y)
    for (int x = -2; x <= 2; ++x) {
      const ivec2 at = pixel + ivec2(x, y) * int(filter_.stride);
      if ((x == 0 && y == 0) || !inPicture(at)) continue;
      const SurfaceTexel there = readSurface(history.surface, at);
      const float w = kKernel[abs(x)] * kKernel[abs(y)] * geometryWeight(here, there, gradient, length(vec2(x, y)) * float(filter_.stride));
      if (w <= 0.0) continue;
      for (uint s = 0u; s < kSignals; ++s) {
        const vec4 tap = imageLoad(images_rgba16f[filter_.source[s]], at);
        const float ws = w * exp(-abs(luminance(tap.rgb) - l[s]) / tolerance[s]);
        light[s].rgb += ws * tap.rgb;
        variance[s] += ws * ws * tap.a * tap.a;
        sum[s] += ws;
      }
    }
  for (uint s = 0u; s < kSignals; ++s) light[s] = vec4(light[s].rgb / sum[s], sqrt(variance[s]) / sum[s]);
}

// Albedos and emission come back.
vec3 modulated(ivec2 pixel, vec4 light[kSignals]) {
  const uvec2 albedos = imageLoad(images_rg32ui[history.albedos], pixel).xy;
  vec3 radiance = imageLoad(images_rgba16f[history.emission], pixel).rgb;
  if (albedos.x != 0u) radiance += unpackAlbedo(albedos.x) * light[0].rgb + unpackAlbedo(albedos.y) * light[1].rgb;
  return radiance / history.unit;
}

void main() {
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (!inPicture(pixel)) return;
  const SurfaceTexel here = readSurface(history.surface, pixel);
  vec4 light[kSignals];
  for (uint s = 0u; s < kSignals; ++s) light[s] = imageLoad(images_rgba16f[filter_.source[s]], pixel);
  if (here.depth > 0.0) filterLight(pixel, here, light);
  if (!kLast) {
    for (uint s = 0u; s < kSignals; ++s) imageStore(images_rgba16f[filter_.target[s]], pixel, vec4(stored(light[s].rgb), min(light[s].a, kMostStored)));
    return;
  }
  vec3 radiance = modulated(pixel, light);
  if (float(filter_.accumulated) > kMeanFrom) {
    const float share = smoothstep(log2(kMeanFrom), log2(kMeanAlone), log2(float(filter_.accumulated)));
    radiance = mix(radiance, imageLoad(images_rgba32f[filter_.mean], pixel).rgb, share);
  }
  imageStore(images_rgba32f[frame.radiance], pixel, vec4(radiance, 1.0));
}
