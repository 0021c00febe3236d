#version 460
#extension GL_GOOGLE_include_directive : require
// SVGF's temporal accumulation [Schied et al. 2017, section 4.1 and 4.2]: this tick's light joins the mean over the ticks before,
// at the place where the surface was; its luminance joins the moments. Moments are kept as mean and standard deviation, which
// neither cancel nor overflow in 16 bits.
#include "svgf/signals.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

const float kLeastShare = 0.05;         // of a new sample in the light's mean
const float kLeastShareOfMoments = 0.2;
const float kAlikeNormals = 0.9;        // cosine
const float kLeastWeight = 0.01;        // of the bilinear taps: with less, look around

struct History {
  vec4 light[kSignals];  // a: standard deviation
  vec4 moments;          // mean and second moment of the luminance: diffuse, specular
  vec2 samples;
  float weight;
};

// Adds the tick before's texel, if it shows the same surface and is made of numbers.
void addTap(inout History sum, ivec2 texel, SurfaceTexel here, float depth, float gradient, float weight) {
  if (weight <= 0.0 || !inPicture(texel)) return;
  const SurfaceTexel there = readSurface(history.previous_surface, texel);
  if (there.depth == 0.0 || there.instance != here.instance || dot(there.normal, here.normal) < kAlikeNormals) return;
  if (abs(there.depth - depth) > 2.0 * gradient + 0.01 * depth) return;
  vec4 light[kSignals];
  for (uint s = 0u; s < kSignals; ++s) light[s] = imageLoad(images_rgba16f[history.filtered[s]], texel);
  const vec4 m = imageLoad(images_rgba16f[history.previous_moments], texel);
  const vec4 samples = vec4(imageLoad(images_rg16f[history.previous_samples], texel).xy, 0.0, 0.0);
  if (!isNumber(light[0]) || !isNumber(light[1]) || !isNumber(m) || !isNumber(samples)) return;
  for (uint s = 0u; s < kSignals; ++s) sum.light[s] += weight * light[s];
  sum.moments += weight * vec4(m.x, m.y * m.y + m.x * m.x, m.z, m.w * m.w + m.z * m.z);
  sum.samples += weight * samples.xy;
  sum.weight += weight;
}

History lookBack(ivec2 pixel, SurfaceTexel here) {
  History sum;
  sum.light[0] = sum.light[1] = sum.moments = vec4(0.0);
  sum.samples = vec2(0.0);
  sum.weight = 0.0;
  if (history.valid == 0u) return sum;
  const vec4 motion = imageLoad(images_rgba16f[history.motion], pixel);
  const vec2 at = vec2(pixel) + motion.xy;
  const ivec2 corner = ivec2(floor(at));
  const vec2 f = at - vec2(corner);
  const float depth = here.depth + motion.z, gradient = motion.w;
  for (int i = 0; i < 4; ++i) {
    const ivec2 offset = ivec2(i & 1, i >> 1);
    const vec2 w = mix(1.0 - f, f, vec2(offset));
    addTap(sum, corner + offset, here, depth, gradient, w.x * w.y);
  }
  if (sum.weight < kLeastWeight) {  // thin things: the nearest texels that fit
    const ivec2 nearest = ivec2(round(at));
    for (int i = 0; i < 9; ++i) addTap(sum, nearest + ivec2(i % 3 - 1, i / 3 - 1), here, depth, gradient, 1.0);
  }
  return sum;
}

void main() {
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (!inPicture(pixel)) return;
  const SurfaceTexel here = readSurface(history.surface, pixel);
  vec4 integrated[kSignals] = vec4[](vec4(0.0), vec4(0.0));
  vec4 moments = vec4(0.0);
  vec2 samples = vec2(0.0);
  if (here.depth > 0.0) {
    const History before = lookBack(pixel, here);
    vec4 sampled[kSignals] = vec4[](imageLoad(images_rgba16f[history.diffuse], pixel), imageLoad(images_rgba16f[history.specular], pixel));
    const bool dropped = sampled[0].a == 0.0;
    for (uint s = 0u; s < kSignals; ++s) {
      const bool known = before.weight > 0.0;
      const float scale = known ? history.rescale / before.weight : 0.0;
      const float count = known ? before.samples[s] / before.weight : 0.0;
      samples[s] = min(count + (dropped ? 0.0 : 1.0), history.most_samples);
      float share = max(1.0 / max(samples[s], 1.0), kLeastShare), share_of_moments = max(1.0 / max(samples[s], 1.0), kLeastShareOfMoments);
      if (dropped) share = share_of_moments = known ? 0.0 : 1.0;
      const float l = luminance(sampled[s].rgb);
      integrated[s].rgb = mix(before.light[s].rgb * scale, sampled[s].rgb, share);
      const vec2 m = mix(vec2(before.moments[2u * s] * scale, before.moments[2u * s + 1u] * scale * history.rescale), vec2(l, l * l), share_of_moments);
      const float deviation = sqrt(max(0.0, m.y - m.x * m.x));
      // What is filtered is the mean, so what guides the filter is the mean's deviation. (The paper guides it by a sample's: then
      // a picture that stands still is blurred as much after many ticks as after few.) An exponential mean of independent
      // samples has the variance share / (2 - share) of one.
      integrated[s].a = min(deviation * sqrt(max(1.0 / max(samples[s], 1.0), share / (2.0 - share))), kMostStored);
      moments[2u * s] = min(m.x, kMostStored);
      moments[2u * s + 1u] = min(deviation, kMostStored);
    }
  }
  for (uint s = 0u; s < kSignals; ++s) imageStore(images_rgba16f[history.integrated[s]], pixel, vec4(stored(integrated[s].rgb), integrated[s].a));
  imageStore(images_rgba16f[history.moments], pixel, moments);
  imageStore(images_rg16f[history.samples], pixel, vec4(samples, 0.0, 0.0));
}
