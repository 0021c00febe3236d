// The light of a path by the lobe of the first surface that it shows, each part over that lobe's albedo: what denoisers filter. The
// parts times their albedos add up to the path's radiance. Only with kSplit.
//
// A mirror shows the surface behind it: primary surface replacement [Panteleev 2018, Practical solutions for ray tracing content
// compatibility]. Its tint joins that surface's albedos, its place is where it seems to be, and lib/motion.glsl follows it there.
#ifndef HELIO_SPLIT_GLSL
#define HELIO_SPLIT_GLSL
#include "lib/history.glsl"
#include "lib/indirect.glsl"
#include "lib/random.glsl"
#include "lib/surface.glsl"
#include "lib/technique.glsl"

// Of the path that this invocation traces.
struct Split {
  bool shown;          // the path has come to the surface that it shows
  vec3 emission;       // that the camera sees without a scattering, in this launch
  vec3 diffuse;        // light that shadow rays of the shown surface brought, by its lobe
  vec3 specular;
  vec3 further;        // light of all that comes after, in this launch
  uint diffuse_share;  // of `further` that came by the diffuse lobe: packShare()
  float carried;       // > 0: `further` is what came along the ray times this, and is left to lib/indirect.glsl
  float hit_distance;  // from the shown surface to the next, metres; 0: not known in this launch
};
Split split_;

void startSplit() {
  if (!kSplit) return;
  split_.shown = false;
  split_.emission = split_.diffuse = split_.specular = split_.further = vec3(0.0);
  split_.diffuse_share = 0u;
  split_.carried = split_.hit_distance = 0.0;
}

// Shares as they wait for rays and for launches: both lobes' are of one rounded number, so nothing is lost.
uint packShare(vec3 share) { return packUnorm4x8(vec4(share, 0.0)); }
vec3 unpackShare(uint share) { return unpackUnorm4x8(share).rgb; }
// In the fourth byte of the share of a shadow ray that waits: it is one of the shown surface.
const uint kOfShown = 1u << 24;
uint ofShown(uint share) { return share | kOfShown; }
bool isOfShown(uint share) { return kSplit && (share & kOfShown) != 0u; }

// The diffuse lobe's share of what the surface scatters from `wi` to `wo`, given f |cos wi| of both lobes.
uint diffuseShare(Bsdf b, vec3 wo, vec3 wi, vec3 f) {
  if (!kSplit) return 0u;
  if (!b.specular) return packShare(vec3(1.0));
  const vec3 diffuse = underCoat(b, wo.z, wi.z) * b.diffuse * (max(wi.z, 0.0) * kInvPi);
  return packShare(mix(vec3(0.0), diffuse / f, greaterThan(f, vec3(0.0))));
}

// A mirror that shows what is behind it, and nothing of its own: of two mirrors that face each other the second is the surface.
bool showsWhatIsBehind(Surface s, uint vertex) {
  return kSplit && kMirrors && vertex == 0u && s.bsdf.mirror && maxComponent(s.bsdf.diffuse) < kLeastAlbedo;
}

// A shadow ray of the shown surface found its light.
void addDirect(vec3 light, uint diffuse_share) {
  if (!kSplit) return;
  const vec3 diffuse = light * unpackShare(diffuse_share);
  split_.diffuse += diffuse;
  split_.specular += light - diffuse;
}
// Light that the path's ray has met, or that arrived at a later vertex.
void addFurther(vec3 light) {
  if (!kSplit) return;
  if (split_.shown) split_.further += light;
  else split_.emission += light;
}

// How far the next surface is, of the sample: the first to know it tells.
void noteHitDistance(float distance) {
  if (kHitDistances && split_.shown && split_.hit_distance == 0.0) split_.hit_distance = distance;
}
// In the place of the specular lobe's deviation of a sample, with kHitDistances: below 0 where it is known.
float packHitDistance(float distance) { return -clamp(distance, 1e-4, kMostStored); }

// Between launches: what tells where the path's light belongs.
uint packCarried() { return split_.carried > 0.0 ? 0x80000000u | floatBitsToUint(split_.carried) : split_.diffuse_share; }
void unpackCarried(uint state) {
  if (kSharesIndirect && (state & 0x80000000u) != 0u) split_.carried = uintBitsToFloat(state & 0x7fffffffu);
  else split_.diffuse_share = state;
}

// At the shown surface: whether its path goes on, where paths do so at a lower rate. What a mirror reflects always does.
bool goesOnFromShown(uvec2 pixel, Surface s, vec3 wo, bool drawn, BsdfSample bsdf, inout vec3 throughput) {
  storeIndirectSurface(pixel, s.frame_ * wo, s.bsdf);
  if (drawn && bsdf.mirror) return true;
  if (!followsIndirect(pixel)) return false;
  if (!drawn) {
    storeIndirectNothing(pixel);
    return false;
  }
  // What comes along the ray is grey here, so that it can be told in all of its colours.
  const vec3 diffuse = bsdf.weight * unpackShare(diffuseShare(s.bsdf, wo, bsdf.wi, bsdf.weight * bsdf.pdf)), specular = bsdf.weight - diffuse;
  const vec2 weights = vec2(luminance(diffuse) / max(luminance(s.bsdf.diffuse), kLeastAlbedo),
                            luminance(specular) / max(luminance(glossyAlbedo(s.bsdf, wo)), kLeastAlbedo));
  storeIndirectRay(pixel, s.frame_ * bsdf.wi, bsdf.pdf, weights);
  throughput = vec3(maxComponent(throughput));
  split_.carried = throughput.x;
  return true;
}

// What denoisers must know of the surface that the path shows, `distance` metres along the path from the camera, whose first ray
// had the direction `seen`. `tint`: of the mirror that it is seen in.
void storeSurface(ivec2 pixel, Surface s, vec3 wo, vec3 seen, float distance, vec3 tint, bool mirrored) {
  const vec3 specular = glossyAlbedo(s.bsdf, wo);
  uvec2 surface = uvec2(packSurface(s.frame_[2], s.slot, mirrored), packDepth(dot(seen, frame.forward) * distance, mirrored));
  if (push.tick_sample > 0u) surface.y |= imageLoad(images_rg32ui[history.surface], pixel).y & kSunlitBits;
  const uvec2 albedos = withRoughness(uvec2(packAlbedo(tint * s.bsdf.diffuse), packAlbedo(tint * specular)), sqrt(s.bsdf.alpha));
  imageStore(images_rg32ui[history.surface], pixel, uvec4(surface, 0u, 0u));
  imageStore(images_rg32ui[history.albedos], pixel, uvec4(albedos, 0u, 0u));
}
// What the sample's shadow ray of the shown surface found; of several samples a tick their mean is kept.
void storeSunlit(ivec2 pixel, float sunlit) {
  if (!kSplit) return;
  uvec2 surface = imageLoad(images_rg32ui[history.surface], pixel).xy;
  const float mean = mix(surfaceSunlit(surface.y), sunlit, 1.0 / float(push.tick_sample + 1u));
  surface.y = withSunlit(surface.y, mean, 0.5);
  imageStore(images_rg32ui[history.surface], pixel, uvec4(surface, 0u, 0u));
}
// The same of all of the sun's light that scatters there: `light`, if nothing stood in its way, and how much of it arrived, [0, 1].
// `steady`: what makes of the diffuse lobe's light that of the sun's middle, which is the mean over its disc.
void storeSunlight(ivec2 pixel, vec3 light, uint diffuse_share, float steady, float arrived) {
  const uvec2 albedos = imageLoad(images_rg32ui[history.albedos], pixel).xy;
  const vec3 diffuse = light * unpackShare(diffuse_share);
  vec2 by_lobe = history.unit * vec2(steady * luminance(diffuse / unpackAlbedo(albedos.x)), luminance((light - diffuse) / unpackAlbedo(albedos.y)));
  by_lobe = isNumber(by_lobe.xyxy) ? min(by_lobe, vec2(kMostStored)) : vec2(0.0);
  if (push.tick_sample > 0u) by_lobe = mix(imageLoad(images_rg16f[history.sunlight], pixel).xy, by_lobe, 1.0 / float(push.tick_sample + 1u));
  imageStore(images_rg16f[history.sunlight], pixel, vec4(by_lobe, 0.0, 0.0));
  storeSunlit(pixel, arrived);
}
// Whether the sky was seen there, and how much of its light the surface lets through to its diffuse lobe.
void storeOcclusion(ivec2 pixel, bool open, float through) {
  vec2 found = vec2(float(open), through);
  if (push.tick_sample > 0u) found = mix(imageLoad(images_rg8[history.occlusion], pixel).xy, found, 1.0 / float(push.tick_sample + 1u));
  imageStore(images_rg8[history.occlusion], pixel, vec4(found, 0.0, 0.0));
}
// The path shows none: the sky, itself or in a mirror.
void storeNoSurface(ivec2 pixel, bool mirrored) {
  const uvec2 surface = uvec2(0u, packDepth(0.0, mirrored)), albedos = uvec2(0u);
  imageStore(images_rg32ui[history.surface], pixel, uvec4(surface, 0u, 0u));
  imageStore(images_rg32ui[history.albedos], pixel, uvec4(albedos, 0u, 0u));
}

// A further path's share in the mean over its pixel's paths, which are counted where a sample has a deviation: what was dropped takes
// with it what came before it, and the next begins anew.
float shareOfFurther(inout LobeLight light, bool first_launch) {
  if (!first_launch) return 1.0 / max(light.deviation.x, 1.0);
  const float before = light.deviation.x;
  light.deviation = vec2(before + 1.0, before > 0.0 ? light.deviation.y : 1.0);
  return 1.0 / (before + 1.0);
}

// Adds what this launch found to what the launches before it did; of several samples a tick, and of further paths, the mean is kept. A
// dropped sample counts as none.
void storeSplit(ivec2 pixel, bool first_launch, bool dropped) {
  const bool emits = maxComponent(split_.emission) > 0.0, lit = maxComponent(split_.diffuse + split_.specular + split_.further) > 0.0;
  if (!first_launch && !dropped && !emits && !lit && !(kHitDistances && split_.hit_distance > 0.0)) return;  // most later launches
  float share = 1.0 / float(push.tick_sample + 1u);  // of this sample in the mean
  LobeLight light = LobeLight(vec3[](vec3(0.0), vec3(0.0)), vec2(1.0));
  vec3 emission = vec3(0.0);
  if (!first_launch || push.tick_sample > 0u) {
    light = sampledLight(pixel);
    if (first_launch || emits) emission = unpackLight(imageLoad(images_r32ui[history.emission], pixel).x);
  }
  if (kFurther) share = shareOfFurther(light, first_launch);
  if (first_launch && push.tick_sample > 0u) {
    for (int lobe = 0; lobe < 2; ++lobe) light.rgb[lobe] *= 1.0 - share;
    emission *= 1.0 - share;
  }
  if (kHitDistances && light.deviation.y > 0.0 && split_.hit_distance > 0.0) light.deviation.y = packHitDistance(split_.hit_distance);
  if (dropped) {
    light.deviation = vec2(0.0);
    if (kSharesIndirect) storeNoIndirect(uvec2(pixel));
  } else {
    const uvec2 albedos = imageLoad(images_rg32ui[history.albedos], pixel).xy;
    const float scale = history.unit * share;
    if (kSharesIndirect && split_.carried > 0.0) {
      addIndirectLight(uvec2(pixel), split_.further / split_.carried);
      split_.further = vec3(0.0);
    }
    if (albedos.x != 0u) {
      const vec3 by_diffuse = split_.further * unpackShare(split_.diffuse_share);
      light.rgb[0] += scale * (split_.diffuse + by_diffuse) / unpackAlbedo(albedos.x);
      light.rgb[1] += scale * (split_.specular + split_.further - by_diffuse) / unpackAlbedo(albedos.y);
    }
    emission += scale * split_.emission;
  }
  // Several paths round the mean again and again.
  const float chance = kFurther ? randomAt(uvec2(pixel), push.seed + push.sample_index, 128u * push.tick_sample + push.launch).x : 0.5;
  writeLight(history.sampled, history.sampled_deviation, pixel, light, chance);
  if (first_launch || emits) imageStore(images_r32ui[history.emission], pixel, uvec4(packLight(stored(emission))));
}

#endif
