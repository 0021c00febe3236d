#version 460
#extension GL_GOOGLE_include_directive : require
// Temporal anti-aliasing [Karis 2014, High-quality temporal supersampling; Lipp 2021, section 6.12]: ticks look at different points of
// the pixel, and the picture is their running mean, followed along the motion. What no longer fits is cut to what the
// neighbourhood has now: its mean and three standard deviations on either side. Light is averaged as light, as in a reference.
#include "taa/taa.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

// Ticks in the mean at most: the history keeps 0.9. (Lipp adds a tenth of the history to the present, which would leave 82 % of
// the variance; so it is 5 %.) Where nothing moves, and what was kept still fits, there may be more of them; not many more, for a
// plain mean of the jitter's points comes near the truth more slowly than one that forgets. The quicker things move the fewer: each tick reads the mean between its
// pixels, and edges are where they were guessed to be.
const float kMostTicks = 10.0, kLeastTicks = 2.0, kMostTicksAtRest = 16.0;
const float kDeviations = 3.0;
const float kFits = 0.02;  // relative: so much may be cut of what still fits

vec3 present(ivec2 pixel) {
  const ivec2 last = ivec2(frame.width, frame.height) - 1;
  return stored(imageLoad(images_rgba32f[frame.radiance], clamp(pixel, ivec2(0), last)).rgb * history.unit);
}

// Of the neighbour that moves farthest: so that the edge of what moves moves with it.
vec2 motionAround(ivec2 pixel) {
  const ivec2 last = ivec2(frame.width, frame.height) - 1;
  vec2 motion = imageLoad(images_rgba16f[history.motion], pixel).xy;
  for (int i = 0; i < 4; ++i) {
    const ivec2 corner = ivec2(i & 1, i >> 1) * 2 - 1;
    const vec2 other = imageLoad(images_rgba16f[history.motion], clamp(pixel + corner, ivec2(0), last)).xy;
    // What was nowhere does not count.
    if (dot(other, other) > dot(motion, motion) && maxComponent(vec3(abs(other), 0.0)) < kMostStored) motion = other;
  }
  return motion;
}

vec4 weightsCubic(float f) {  // Catmull-Rom
  const float f2 = f * f, f3 = f2 * f;
  return 0.5 * vec4(-f + 2.0 * f2 - f3, 2.0 - 5.0 * f2 + 3.0 * f3, f + 4.0 * f2 - 3.0 * f3, f3 - f2);
}

// The mean over the ticks before at a point of the picture; a: ticks in it, 0 where there is none.
vec4 meanBefore(vec2 at) {
  const ivec2 corner = ivec2(floor(at));
  const vec2 f = at - vec2(corner);
  const ivec2 last = ivec2(frame.width, frame.height) - 1;
  if (history.known == 0u || any(lessThan(at, vec2(-0.5))) || any(greaterThan(at, vec2(last) + 0.5))) return vec4(0.0);
  if (all(lessThan(f, vec2(1.0 / 256.0)))) return unpackHalf4(imageLoad(images_rg32ui[taa.mean], clamp(corner, ivec2(0), last)).xy);
  const vec4 across = weightsCubic(f.x), down = weightsCubic(f.y);
  vec4 sum = vec4(0.0);
  float ticks = kMostTicksAtRest;
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 4; ++x) {
      const vec4 tap = unpackHalf4(imageLoad(images_rg32ui[taa.mean], clamp(corner + ivec2(x, y) - 1, ivec2(0), last)).xy);
      sum += across[x] * down[y] * tap;
      if ((x & 3) % 3 != 0 && y % 3 != 0) ticks = min(ticks, tap.a);  // of the four nearest
    }
  return vec4(max(sum.rgb, vec3(0.0)), ticks);
}

void main() {
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (!inPicture(pixel)) return;
  const vec3 here = present(pixel);
  vec3 mean = here, square = here * here;
  for (int i = 0; i < 9; ++i) {
    if (i == 4) continue;
    const vec3 c = present(pixel + ivec2(i % 3, i / 3) - 1);
    mean += c;
    square += c * c;
  }
  mean /= 9.0;
  const vec3 reach = kDeviations * sqrt(max(square / 9.0 - mean * mean, vec3(0.0)));
  const vec2 motion = motionAround(pixel);
  vec4 before = meanBefore(vec2(pixel) + motion);
  if (!isNumber(before)) before = vec4(0.0);
  const vec3 kept = before.rgb * history.rescale, fitting = clamp(kept, mean - reach, mean + reach);
  const bool rests = motion == vec2(0.0) && all(lessThanEqual(abs(kept - fitting), kFits * kept));
  const float quick = max(kMostTicks / (1.0 + length(motion)), kLeastTicks);
  const float ticks = min(before.a + 1.0, rests ? kMostTicksAtRest : quick);
  imageStore(images_rg32ui[taa.resolved], pixel, uvec4(packHalf4(vec4(stored(mix(fitting, here, 1.0 / ticks)), ticks)), 0u, 0u));
}
