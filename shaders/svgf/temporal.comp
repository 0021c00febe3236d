#version 460
#extension GL_GOOGLE_include_directive : require
// SVGF's temporal accumulation [Schied et al. 2017, section 4.1 and 4.2]: this tick's light joins the mean over the ticks before,
// at the place where the surface was; its luminance joins the moments. Moments are kept as mean and standard deviation, which
// neither cancel nor overflow in 16 bits.
#include "lib/gradients.glsl"
#include "lib/random.glsl"
#include "svgf/signals.glsl"

layout(local_size_x = 8, local_size_y = 8) in;
// A-SVGF: where light changes the history counts for less [Schied et al. 2018, section 4.4].
layout(constant_id = 0) const bool kAdaptive = false;

const float kLeastShare = 0.05;         // of a new sample in the light's mean
// Moments of few ticks tell sooner how noisy it is. Where no filter's mean returns, a single bright sample stays in the mean, and the
// moments must know of it for as long, or no filter will take it.
const float kLeastShareOfMoments = kAdaptive ? kLeastShare : 0.2;
const float kLeastWeight = 0.01;        // of the bilinear taps: with less, look around

struct History {
  vec3 light[kSignals];
  vec4 moments;          // mean and second moment of the luminance: diffuse, specular
  vec2 samples;
  float weight;
};

// Adds the tick before's texel, if it is made of numbers.
void addTap(inout History sum, ivec2 texel, float weight) {
  const uvec2 light = imageLoad(images_rg32ui[history.filtered], texel).xy;  // cannot be but numbers
  const vec4 m = unpackHalf4(imageLoad(images_rg32ui[history.moments], texel).xy);
  if (!isNumber(m)) return;
  sum.light[0] += weight * unpackLight(light.x);
  sum.light[1] += weight * unpackLight(light.y);
  sum.moments += weight * vec4(m.x, m.y * m.y + m.x * m.x, m.z, m.w * m.w + m.z * m.z);
  sum.samples += weight * gatheredTicks(texel);
  sum.weight += weight;
}

History lookBack(ivec2 pixel, SurfaceTexel here) {
  History sum;
  sum.light[0] = sum.light[1] = vec3(0.0);
  sum.moments = vec4(0.0);
  sum.samples = vec2(0.0);
  sum.weight = 0.0;
  if (history.known == 0u) return sum;
  const vec4 motion = imageLoad(images_rgba16f[history.motion], pixel);
  const Look look = lookedAt(pixel, here, motion);
  ivec2 texel;
  SurfaceTexel there;
  for (int i = 0; i < 4; ++i) {
    const float w = tapOf(look, i, here, motion.w, texel, there);
    if (w > 0.0) addTap(sum, texel, w);
  }
  if (sum.weight < kLeastWeight)
    for (int i = 0; i < 9; ++i)
      if (besideOf(look, i, here, motion.w, texel, there)) addTap(sum, texel, 1.0);
  return sum;
}

// Share of the light that is another than before, [0, 1]: diffuse, specular.
vec2 changeOf(ivec2 pixel) {
  if (!kAdaptive || history.reshades == 0u) return vec2(0.0);
  return imageLoad(images_rg8[history.changes], pixel / int(kStratum)).xy;
}

void main() {
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (!inPicture(pixel)) return;
  const SurfaceTexel here = readSurface(history.surface, pixel);
  LobeLight integrated = LobeLight(vec3[](vec3(0.0), vec3(0.0)), vec2(0.0));
  vec4 moments = vec4(0.0);
  vec2 samples = vec2(0.0);
  if (here.depth > 0.0) {
    const History before = lookBack(pixel, here);
    const LobeLight sampled = sampledLight(pixel);
    const bool dropped = sampled.deviation.x == 0.0, known = before.weight > 0.0;
    const vec2 change = changeOf(pixel);
    const float scale = known ? history.rescale / before.weight : 0.0;
    for (uint s = 0u; s < kSignals; ++s) {
      const float count = known ? before.samples[s] / before.weight * (1.0 - change[s]) : 0.0;
      samples[s] = min(count + (dropped ? 0.0 : 1.0), float(kMostTicksOfLight));
      const float plain = 1.0 / max(samples[s], 1.0);
      float share = mix(max(plain, kLeastShare), 1.0, change[s]), share_of_moments = mix(max(plain, kLeastShareOfMoments), 1.0, change[s]);
      if (dropped) share = share_of_moments = known ? 0.0 : 1.0;
      const float l = luminance(sampled.rgb[s]);
      integrated.rgb[s] = mix(before.light[s] * scale, sampled.rgb[s], share);
      const vec2 m = mix(vec2(before.moments[2u * s] * scale, before.moments[2u * s + 1u] * scale * history.rescale), vec2(l, l * l), share_of_moments);
      const float deviation = sqrt(max(0.0, m.y - m.x * m.x));
      // What is filtered is the mean, so what guides the filter is the mean's deviation. (The paper guides it by a sample's: then
      // a picture that stands still is blurred as much after many ticks as after few.) An exponential mean of independent
      // samples has the variance share / (2 - share) of one.
      integrated.deviation[s] = deviation * sqrt(max(plain, share / (2.0 - share)));
      moments[2u * s] = min(m.x, kMostStored);
      moments[2u * s + 1u] = min(deviation, kMostStored);
    }
    keepSunlit(pixel);
  }
  writeLight(history.sampled, history.sampled_deviation, pixel, integrated, randomAt(uvec2(pixel), history.tick, 0u).x);
  // Neighbours may still look at those of the tick before.
  imageStore(images_rg32ui[history.spare], pixel, uvec4(packHalf4(moments), 0u, 0u));
  imageStore(images_rg16f[history.spare_deviation], pixel, vec4(samples, 0.0, 0.0));
}
