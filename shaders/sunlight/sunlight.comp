#version 460
#extension GL_GOOGLE_include_directive : require
// The sun's light on the surfaces that pixels show. As if nothing stood in its way it has no noise worth a filter; what is noisy is
// whether the sun is seen, and that only in penumbras: one number a pixel, a mean over ticks, and over neighbours while it is young.
// What comes of it joins the light that nothing filters any more.
#include "svgf/signals.glsl"

const int kGroup = 16, kMargin = 2;
layout(local_size_x = kGroup, local_size_y = kGroup) in;

const int kColumns = kGroup + 2 * kMargin, kTaps = kColumns * kColumns;
const float kLeastShare = 0.05;  // of a new sample in the mean
const float kKernel[3] = float[](3.0 / 8.0, 1.0 / 4.0, 1.0 / 16.0);
const uint kSide = 2u * uint(kMargin) + 1u;
const uint kNotLastColumn = 0xf7bdefu;  // of 5 x 5 bits row by row: of each row the first four

shared uvec2 surfaces[kTaps];
const uint kLit = 1u, kDark = 2u;
shared uint flags[kTaps];  // some light came, some did not; 0: there is no surface

// Nearly everywhere it is all the same.
bool agree(int middle) {
  uint all = 0u;
  for (int y = -kMargin; y <= kMargin; ++y)
    for (int x = -kMargin; x <= kMargin; ++x) all |= flags[middle + y * kColumns + x];
  return all != (kLit | kDark);
}

struct Before {
  float sunlit, ticks, weight;
};
Before lookBack(ivec2 pixel, SurfaceTexel here, vec4 motion) {
  Before sum = Before(0.0, 0.0, 0.0);
  if (history.known == 0u) return sum;
  const Look look = lookedAt(pixel, here, motion);
  for (int i = 0; i < 4; ++i) {
    ivec2 texel;
    SurfaceTexel there;
    const float w = tapOf(look, i, here, motion.w, texel, there);
    if (w <= 0.0) continue;
    sum.sunlit += w * there.sunlit;
    sum.ticks += w * gatheredTicks(texel).x;
    sum.weight += w;
  }
  return sum;
}

// Neither light nor shade, for a mean over ticks.
bool isBetween(float mean) { return mean > 0.04 && mean < 0.96; }

// Else the pixel's own samples are good enough. What has no history though nothing moves are edges that TAA's jitter brings.
bool mayBePenumbra(Before before, float mean, vec4 motion) {
  if (before.weight > 0.0) return isBetween(mean);
  return history.known == 0u || motion.xy != vec2(0.0);
}

// How disordered samples are: of neighbouring pairs of independent ones 2 m (1 - m) differ, along an edge at most half as many do. A bit a pixel.
float disorder(uint alike, uint lit) {
  const uint pairs_x = alike & (alike >> 1) & kNotLastColumn, pairs_y = alike & (alike >> kSide);
  const float pairs = float(bitCount(pairs_x) + bitCount(pairs_y));
  const float differ = float(bitCount(pairs_x & (lit ^ (lit >> 1))) + bitCount(pairs_y & (lit ^ (lit >> kSide))));
  const float m = float(bitCount(lit)) / float(bitCount(alike)), expected = 2.0 * m * (1.0 - m) * pairs;
  return expected > 0.0 ? smoothstep(0.75, 1.0, differ / expected) : 0.0;
}

// What the pixel's sample found, and in a penumbra what those of 5 x 5 pixels of the same surface did. A penumbra is where all of them were
// between light and shade before: beside a hard edge, which TAA's jitter moves to and fro, most were not. Where nothing is known of
// before, it is where samples are in disorder.
float found(ivec2 pixel, int middle, SurfaceTexel here, vec4 motion, bool known) {
  const ivec2 moved = ivec2(round(motion.xy));
  float sum = 0.0, weights = 0.0, between = 0.0;
  uint alike = 0u, lit = 0u;
  for (uint i = 0u; i < kSide * kSide; ++i) {
    const ivec2 offset = ivec2(i % kSide, i / kSide) - kMargin;
    const SurfaceTexel there = unpackSurface(surfaces[middle + offset.y * kColumns + offset.x]);
    const float w = geometryWeight(here, there, motion.w, length(vec2(offset)));
    if (w < 0.1) continue;
    const float kernel = kKernel[abs(offset.x)] * kKernel[abs(offset.y)] * w;
    sum += kernel * there.sunlit;
    weights += kernel;
    alike |= 1u << i;
    if (there.sunlit > 0.5) lit |= 1u << i;
    const ivec2 before = pixel + offset + moved;
    if (known && inPicture(before)) {
      const float sunlit = readSurface(history.previous_surface, before).sunlit;
      between += float(isBetween(sunlit));
    }
  }
  const float penumbra = known ? smoothstep(0.4, 0.8, between / float(bitCount(alike))) : disorder(alike, lit);
  return mix(here.sunlit, sum / weights, penumbra);
}

void main() {
  const ivec2 group = ivec2(gl_WorkGroupID.xy) * kGroup, point = ivec2(gl_LocalInvocationID.xy), pixel = group + point;
  for (int i = int(gl_LocalInvocationIndex); i < kTaps; i += kGroup * kGroup) {
    const ivec2 at = group + ivec2(i % kColumns, i / kColumns) - kMargin;
    surfaces[i] = inPicture(at) ? imageLoad(images_rg32ui[history.surface], at).xy : uvec2(0u);
    const SurfaceTexel there = unpackSurface(surfaces[i]);
    flags[i] = there.depth == 0.0 ? 0u : (there.sunlit > 0.0 ? kLit : 0u) | (there.sunlit < 1.0 ? kDark : 0u);
  }
  // What only this pixel needs is on its way while the group waits.
  const ivec2 own = min(pixel, ivec2(frame.width, frame.height) - 1);
  const vec4 motion = imageLoad(images_rgba16f[history.motion], own);
  const bool dropped = imageLoad(images_rg16f[history.sampled_deviation], own).x == 0.0;
  const vec2 open = imageLoad(images_rg16f[history.sunlight], own).xy;
  const uvec2 albedos = imageLoad(images_rg32ui[history.albedos], own).xy;
  const uint emission = imageLoad(images_r32ui[history.emission], own).x;
  barrier();
  if (!inPicture(pixel)) return;
  const int middle = (point.y + kMargin) * kColumns + point.x + kMargin;
  const SurfaceTexel here = unpackSurface(surfaces[middle]);
  if (here.depth == 0.0) return;

  const Before before = lookBack(pixel, here, motion);
  const bool unanimous = agree(middle);
  const float mean = before.weight > 0.0 ? before.sunlit / before.weight : 0.0;
  float sunlit = here.sunlit;
  if (!unanimous && mayBePenumbra(before, mean, motion)) sunlit = found(pixel, middle, here, motion, before.weight > 0.0);
  if (before.weight > 0.0) {
    float share = max(1.0 / (before.ticks / before.weight + 1.0), kLeastShare);
    // A shadow has come or left: all around agree, so it is no penumbra.
    if (unanimous) share = max(share, (mean - sunlit) * (mean - sunlit));
    sunlit = mix(mean, sunlit, dropped ? 0.0 : share);
  }

  const vec3 color = frame.sun_radiance / luminance(frame.sun_radiance);
  const vec3 light = sunlit * color * (unpackAlbedo(albedos.x) * open.x + unpackAlbedo(albedos.y) * open.y);
  imageStore(images_r32ui[history.emission], pixel, uvec4(packLight(stored(unpackLight(emission) + light))));
  imageStore(images_rg16f[history.sunlight], pixel, vec4(sunlit, 0.0, 0.0, 0.0));
}
