#version 460
#extension GL_GOOGLE_include_directive : require
// One iteration of SVGF's edge-avoiding a-trous wavelet filter [Schied et al. 2017, section 4.3 and 4.4; Dammertz et al. 2010]:
// 5 x 5 taps kStride pixels apart. Edges are found in depth, normals, and in luminance as far as its variance lets them be seen.
// The last iteration makes the picture: albedos and emission come back.
#include "lib/random.glsl"

const int kGroup = 16, kMargin = 2;
layout(local_size_x = kGroup, local_size_y = kGroup) in;
layout(constant_id = 0) const int kStride = 1;
layout(constant_id = 1) const bool kLast = false;

#include "svgf/picture.glsl"
#include "svgf/taps.glsl"

const float kKernel[3] = float[](3.0 / 8.0, 1.0 / 4.0, 1.0 / 16.0);  // B3 spline

// Standard deviation, smoothed by a 3 x 3 Gaussian: single estimates are too noisy to steer by.
vec2 smoothDeviation(ivec2 pixel) {
  vec2 variance = vec2(0.0);
  float sum = 0.0;
  for (int y = -1; y <= 1; ++y)
    for (int x = -1; x <= 1; ++x) {
      const ivec2 at = pixel + ivec2(x, y);
      if (!inPicture(at)) continue;
      const vec2 there = imageLoad(images_rg16f[filter_.source_deviation], at).xy;
      const float w = (x == 0 ? 0.5 : 0.25) * (y == 0 ? 0.5 : 0.25);
      variance += w * there * there;
      sum += w;
    }
  return sqrt(variance / sum);
}

LobeLight filteredLight(ivec2 pixel, int middle) {
  const vec4 motion = imageLoad(images_rgba16f[history.motion], pixel);
  const float gradient = motion.w * float(kStride);
  const vec2 per_luminance = 1.0 / (kSigmaLuminance * smoothDeviation(pixel) + 1e-5);
  const vec2 l = luminancesOf(middle);
  const vec4 surface = unpackHalf4(surfaces[middle]);
  const float depth = depths[middle];
  vec3 light[kSignals] = vec3[](vec3(0.0), vec3(0.0));
  vec2 variance = vec2(0.0), sum = vec2(0.0);
  for (int y = -2; y <= 2; ++y)
    for (int x = -2; x <= 2; ++x) {
      const int there = middle + y * kColumns + x;
      const Likeness alike = likeness(surface, depth, there, gradient, length(vec2(x, y)));
      if (!counts(alike)) continue;
      const vec4 diffuse = unpackHalf4(lights[0][there]), specular = unpackHalf4(lights[1][there]);
      const vec2 difference = abs(vec2(luminance(diffuse.rgb), luminance(specular.rgb)) - l) * per_luminance;
      const vec2 w = kKernel[abs(x)] * kKernel[abs(y)] * alike.normals * exp(-(alike.apart + difference));
      const vec2 deviation = w * vec2(diffuse.a, specular.a);
      light[0] += w.x * diffuse.rgb;
      light[1] += w.y * specular.rgb;
      variance += deviation * deviation;
      sum += w;
    }
  return LobeLight(vec3[](light[0] / sum.x, light[1] / sum.y), sqrt(variance) / sum);
}

void main() {
  const ivec2 point = ivec2(gl_LocalInvocationID.xy), pixel = pixelOf(point);
  fetchTaps();
  if (!inPicture(pixel)) return;
  const int middle = tapOf(point);
  const LobeLight light = depths[middle] != 0.0 ? filteredLight(pixel, middle) : readLight(filter_.source, filter_.source_deviation, pixel);
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
