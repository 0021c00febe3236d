#version 460
#extension GL_GOOGLE_include_directive : require
// A spatial stage: 8 taps of a disk on the surface's tangent plane, turned at random, whose radius follows how far the light came from
// and how much has been gathered. Before the accumulation the samples are blurred, behind it the history is: twice, with disks that
// are turned differently.
#include "lib/random.glsl"
#include "reblur/disk.glsl"
#include "reblur/reblur.glsl"

layout(local_size_x = 8, local_size_y = 8) in;
const uint kPreblur = 0u, kBlur = 1u, kPostblur = 2u;
layout(constant_id = 0) const uint kStage = kBlur;

const uint kTaps = 8u;
// Pixels of a picture of 1080 rows. Smaller pictures have smaller things, and as much noise a pixel: half of the stops between.
const float kRowsOfRadius = 1080.0;
const float kRadius = 30.0, kPreblurRadius = 20.0, kPostblurScale = 2.0;
const float kLeastRadius = 1.0;
const float kLeastHitFactor = 0.1;

// A tap of the disk: r uniform by area, on a spiral [Vogel 1979].
vec2 diskTap(uint i, float turn) {
  const float phi = float(i) * 2.39996323 + turn;
  return sqrt((float(i) + 0.5) / float(kTaps)) * vec2(cos(phi), sin(phi));
}

// Smooth lobes are narrow: what lies beside them is another picture.
float lobeWidth(float roughness) { return 1.0 - exp2(-50.0 * roughness * roughness); }

// Of the nearest thing that the light can have come from, over the height of the view there, [0, 1].
float hitFactor(float hit_distance, float depth) { return clamp(hit_distance / max(2.0 * frame.tangent * depth, 1e-6), kLeastHitFactor, 1.0); }

// One sample's distance is as noisy as its light: the mean of what the samples around know. And no sample is a firefly among them.
float lookAround(inout Lobes light, ivec2 pixel, SurfaceTexel here, float gradient) {
  float factors = 0.0, weights = 0.0;
  Surroundings around = noSurroundings();
  for (int i = 0; i < 9; ++i) {
    const ivec2 offset = 2 * (ivec2(i % 3, i / 3) - 1), at = tapAround(pixel, offset);
    if (!inPicture(at)) continue;
    const SurfaceTexel there = readSurface(history.surface, at);
    const float w = i == 4 ? 1.0 : geometryWeight(here, there, gradient, length(vec2(offset)));
    const float d = imageLoad(images_rg16f[history.sampled_deviation], at).y;
    factors += w * (d < 0.0 ? hitFactor(-d, here.depth) : 1.0);
    weights += w;
    if (i != 4 && there.depth > 0.0) addTo(around, luminances(readLobes(filter_.source, at)), w);
  }
  cutFireflies(light.rgb, around, 1.0);
  return factors / weights;
}

// Radii of both lobes, pixels.
vec2 radii(ivec2 pixel, float hit_factor) {
  const float scale = sqrt(float(frame.height) / kRowsOfRadius);
  const vec2 lobe = vec2(1.0, lobeWidth(roughnessAt(pixel)));
  if (kStage == kPreblur) return max(kPreblurRadius * scale * hit_factor * lobe, vec2(0.0));
  const vec2 gathered = gatheredTicks(pixel);
  // A mean of n samples is as smooth as n taps: the disk's area falls with it.
  const float stage = kStage == kPostblur ? kPostblurScale : 1.0;
  return max(kRadius * scale * stage * hit_factor * lobe * inversesqrt(1.0 + gathered), kLeastRadius * lobe);
}

void main() {
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (!inPicture(pixel)) return;
  const SurfaceTexel here = readSurface(history.surface, pixel);
  float hit_factor = 1.0;
  Lobes light = readLobes(filter_.source, pixel);
  if (kStage == kPreblur) {
    imageStore(images_rg16f[history.stabilised], pixel, vec4(imageLoad(images_rg16f[history.spare_deviation], pixel).xy, 0.0, 0.0));
    if (here.depth > 0.0) hit_factor = lookAround(light, pixel, here, gradientAt(pixel));
    // What was dropped is told apart: 0.
    const bool dropped = imageLoad(images_rg16f[history.sampled_deviation], pixel).x == 0.0;
    imageStore(images_rg16f[history.spare_deviation], pixel, vec4(hit_factor, dropped ? 0.0 : 1.0, 0.0, 0.0));
  } else {
    hit_factor = imageLoad(images_rg16f[history.spare_deviation], pixel).x;
  }
  if (here.depth > 0.0) {
    const vec4 motion = imageLoad(images_rgba16f[history.motion], pixel);
    const float gradient = motion.w;
    const vec2 radius = radii(pixel, hit_factor), sharpness = lobeSharpness(roughnessAt(pixel));
    const float ticks = ticksOfSun(motion.xy, kStage == kPreblur ? 1.0 : gatheredTicks(pixel).x);
    const float turn = 6.28318531 * randomAt(uvec2(pixel), history.tick, 16u + kStage).x;
    const TangentDisk disk = tangentDisk(pixel, normalOf(here), here.depth, here.mirrored);
    // A dropped sample is no darkness.
    const float own_weight = kStage == kPreblur && imageLoad(images_rg16f[history.sampled_deviation], pixel).x == 0.0 ? 1e-4 : 1.0;
    for (uint s = 0u; s < kSignals; ++s) {
      if (radius[s] < 0.5) continue;
      CutMean mean = emptyMean();
      addTo(mean, light.rgb[s], own_weight);
      for (uint i = 0u; i < kTaps; ++i) {
        const vec2 tap = diskTap(i, turn + float(s));
        const ivec2 at = ivec2(floor(diskPixel(disk, tap * radius[s])));
        if (at == pixel || !inPicture(at)) continue;
        const SurfaceTexel there = readSurface(history.surface, at);
        float w = lobeLikeness(here, there, gradient, distance(vec2(at), vec2(pixel)), sharpness[s]) * exp(-2.0 * dot(tap, tap)) *
                  sunlitWeight(here, there, ticks);
        if (kStage == kPreblur && imageLoad(images_rg16f[history.sampled_deviation], at).x == 0.0) w = 0.0;
        if (w <= 0.0) continue;
        addTo(mean, unpackLight(s == 0u ? imageLoad(images_rg32ui[filter_.source], at).x : imageLoad(images_rg32ui[filter_.source], at).y), w);
      }
      // Behind the pre-blur no fireflies are left; what is cut then, blurs bring anyway.
      finish(mean, 1.0);
      light.rgb[s] = mean.light / mean.weight;
    }
  }
  writeLobes(filter_.target, pixel, light, randomAt(uvec2(pixel), history.tick, 20u + kStage).x);
}
