#version 460
#extension GL_GOOGLE_include_directive : require
// Chooses a pixel of each stratum at random, whose sample the next tick will shade again, and frees the stratum. The one that was
// shaded again in this tick is left out, so that random numbers do not stay. Nor is what a mirror shows: it is not where it seems.
#include "asvgf/gradients.glsl"
#include "lib/random.glsl"
#include "lib/seen.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

GradientSample sampleOf(uvec2 pixel, uint place) {
  GradientSample chosen;
  chosen.mesh = kNothing;
  if (gradient_.keeps == 0u || !inPicture(ivec2(pixel))) return chosen;
  Hit hit = seenHit(pixel);
  const LobeLight light = sampledLight(ivec2(pixel));
  if (hit.primitive == kNothing || light.deviation.x == 0.0 || surfaceMirrored(imageLoad(images_rg32ui[history.surface], ivec2(pixel)).y)) return chosen;
  const InstanceRecord instance = InstanceTable(frame.instances).items[hit.slot];
  const vec2 ndc = 2.0 * (vec2(pixel) + gradient_.jitter) / vec2(frame.width, frame.height) - 1.0;
  seenTriangle(hit, instance, frame.position, frame.forward + frame.tangent * (ndc.x * frame.aspect * frame.right - ndc.y * frame.up));
  if (hit.level == kLevelInBlas) hit.level = instance.level;
  chosen.hit = packHit(hit);
  chosen.mesh = instance.mesh | place << kPlaceShift;
  chosen.barycentrics = hit.barycentrics;
  chosen.luminance = packHalf2x16(vec2(luminance(light.rgb[0]), luminance(light.rgb[1])));
  return chosen;
}

void main() {
  const uvec2 stratum = gl_GlobalInvocationID.xy;
  if (!inStrata(ivec2(stratum))) return;
  const uint claim = claimOf(stratum);
  uint local = pcg4d(uvec4(stratum, gradient_.seed, 0u)).x % (kStratum * kStratum);
  if (claim != 0u && local == (claim - 1u) % (kStratum * kStratum)) local = (local + 1u) % (kStratum * kStratum);
  GradientSampleTable(history.gradient_samples).items[stratumIndex(stratum)] =
      sampleOf(stratum * kStratum + uvec2(local % kStratum, local / kStratum), local);
  imageStore(images_r32ui[history.claims], ivec2(stratum), uvec4(0u));
}
