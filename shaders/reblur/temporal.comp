#version 460
#extension GL_GOOGLE_include_directive : require
// Temporal accumulation: this tick's light joins the history, which was blurred, with a weight of one over the ticks that it has
// gathered. Where the history is not what the samples around say now, it is brought there, and counts as younger.
#include "lib/random.glsl"
#include "reblur/reblur.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

const float kLeastWeight = 0.01;  // of the bilinear taps: with less, look around
// The window whose samples judge the history, and by how many deviations of their mean it may be off.
const int kWindow = 2, kWindowStride = 2;
const float kDeviations = 3.0;
const float kEnough = 6.0;  // of them, to judge at all

struct History {
  Lobes light;
  vec2 ticks;
  float weight;
};

void addTap(inout History sum, ivec2 texel, float weight) {
  const Lobes light = readLobes(history.filtered, texel);  // cannot be but numbers
  for (uint s = 0u; s < kSignals; ++s) sum.light.rgb[s] += weight * light.rgb[s];
  sum.ticks += weight * gatheredTicks(texel);
  sum.weight += weight;
}

History lookBack(ivec2 pixel, SurfaceTexel here, vec4 motion) {
  History sum = History(Lobes(vec3[](vec3(0.0), vec3(0.0))), vec2(0.0), 0.0);
  if (history.known == 0u) return sum;
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

// What a smooth lobe shows moves otherwise than the surface does: the faster, the less of its history is of use.
float mostSpecularTicks(ivec2 pixel, SurfaceTexel here) {
  const float roughness = roughnessAt(pixel), moved = distance(frame.position, history.position) / max(here.depth, 1e-3);
  const float followed = 32.0 * (1.0 - exp2(-200.0 * roughness * roughness)) * sqrt(roughness);
  return mix(float(kMostTicksOfLight), followed, clamp(moved * 100.0, 0.0, 1.0));
}

// What the blurred samples around say of the instance: mean of the luminance, and how far off a history may be.
void judge(ivec2 pixel, SurfaceTexel here, out vec2 mean, out vec2 reach) {
  vec2 first = vec2(0.0), second = vec2(0.0);
  float sum = 0.0;
  for (int y = -kWindow; y <= kWindow; ++y)
    for (int x = -kWindow; x <= kWindow; ++x) {
      const ivec2 at = pixel + ivec2(x, y) * kWindowStride;
      if (!inPicture(at)) continue;
      const SurfaceTexel there = readSurface(history.surface, at);
      if (there.depth == 0.0 || instanceOf(there) != instanceOf(here) || there.mirrored != here.mirrored) continue;
      const vec2 l = luminances(readLobes(filter_.source, at));
      first += l;
      second += l * l;
      sum += 1.0;
    }
  mean = first / sum;
  reach = sum < kEnough ? vec2(kMostStored) : kDeviations * sqrt(max(second / sum - mean * mean, vec2(0.0)));
}

void main() {
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (!inPicture(pixel)) return;
  const SurfaceTexel here = readSurface(history.surface, pixel);
  Lobes light = readLobes(filter_.source, pixel);
  vec2 ticks = vec2(0.0);
  if (here.depth > 0.0) {
    const vec4 motion = imageLoad(images_rgba16f[history.motion], pixel);
    const History before = lookBack(pixel, here, motion);
    const bool dropped = imageLoad(images_rg16f[history.spare_deviation], pixel).y == 0.0;
    ticks = vec2(1.0);
    if (before.weight > 0.0) {
      vec2 mean, reach;
      judge(pixel, here, mean, reach);
      const vec2 most = vec2(kMostTicksOfLight, mostSpecularTicks(pixel, here));
      for (uint s = 0u; s < kSignals; ++s) {
        const vec3 known = before.light.rgb[s] * (history.rescale / before.weight);
        const float l = luminance(known), fitting = clamp(l, mean[s] - reach[s], mean[s] + reach[s]);
        const float off = abs(l - fitting) / max(max(l, fitting), 1e-6);
        const float gathered = min(before.ticks[s] / before.weight, most[s] - 1.0) * (1.0 - off);
        ticks[s] = gathered + (dropped ? 0.0 : 1.0);
        const vec3 brought = l > 1e-6 ? known * (fitting / l) : known + (fitting - l);
        light.rgb[s] = dropped ? brought : mix(brought, light.rgb[s], 1.0 / max(ticks[s], 1.0));
      }
    }
    keepSunlit(pixel);  // neighbours that judge look at the texel too, but not at these bits
  }
  writeLobes(filter_.target, pixel, light, randomAt(uvec2(pixel), history.tick, 24u).x);
  imageStore(images_rg16f[history.sampled_deviation], pixel, vec4(ticks, 0.0, 0.0));
}
