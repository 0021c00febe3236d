// The light of a path by the lobe of its first vertex, each part over that lobe's albedo: what denoisers filter. The parts times
// their albedos add up to the path's radiance. Only with kSplit.
#ifndef HELIO_SPLIT_GLSL
#define HELIO_SPLIT_GLSL
#include "lib/history.glsl"
#include "lib/surface.glsl"

// Of the path that this invocation traces.
struct Split {
  vec3 emission;       // that the camera sees without a scattering
  vec3 diffuse;        // light that shadow rays of the first vertex brought, by its lobe
  vec3 specular;
  vec3 further;        // light of all that comes after, in this launch
  vec3 diffuse_share;  // of `further` that came by the diffuse lobe
};
Split split_;

void startSplit() {
  if (!kSplit) return;
  split_.emission = split_.diffuse = split_.specular = split_.further = split_.diffuse_share = vec3(0.0);
}

// The diffuse lobe's share of what the surface scatters from `wi` to `wo`, given f |cos wi| of both lobes.
vec3 diffuseShare(Bsdf b, vec3 wo, vec3 wi, vec3 f) {
  if (!kSplit) return vec3(0.0);
  if (!b.specular) return vec3(1.0);
  const vec3 diffuse = underCoat(b, wo.z, wi.z) * b.diffuse * (max(wi.z, 0.0) * kInvPi);
  return clamp(mix(vec3(0.0), diffuse / f, greaterThan(f, vec3(0.0))), 0.0, 1.0);
}

// A shadow ray of the first vertex found its light.
void addDirect(vec3 light, vec3 diffuse_share) {
  if (!kSplit) return;
  split_.diffuse += light * diffuse_share;
  split_.specular += light * (1.0 - diffuse_share);
}
void addFurther(vec3 light) {
  if (kSplit) split_.further += light;
}

// The share as it is kept between launches: both parts are of one rounded number, so nothing is lost.
uint packShare(vec3 share) { return packUnorm4x8(vec4(share, 0.0)); }
vec3 unpackShare(uint share) { return unpackUnorm4x8(share).rgb; }

// What denoisers must know of the first surface. Without one, `s` is not looked at.
void storeSurface(ivec2 pixel, bool hit, Surface s, vec3 wo) {
  uvec2 surface = uvec2(0u), albedos = uvec2(0u);
  if (hit) {
    surface = uvec2(packSurface(s.frame_[2], s.slot), floatBitsToUint(max(dot(s.position - frame.position, frame.forward), 1e-6)));
    const vec3 specular = s.bsdf.compensation * coatAlbedo(s.bsdf, s.bsdf.coat.y * pow(clamp(1.0 - wo.z, 0.0, 1.0), s.bsdf.coat.x));
    albedos = uvec2(packAlbedo(s.bsdf.diffuse), packAlbedo(specular));
  }
  imageStore(images_rg32ui[history.surface], pixel, uvec4(surface, 0u, 0u));
  imageStore(images_rg32ui[history.albedos], pixel, uvec4(albedos, 0u, 0u));
}

// Adds what this launch found to what the launches before it did; of several samples a tick their mean is kept. A dropped sample
// counts as none.
void storeSplit(ivec2 pixel, bool first_launch, bool dropped) {
  const float share = 1.0 / float(push.tick_sample + 1u);  // of this sample in the mean
  vec4 diffuse = vec4(0.0, 0.0, 0.0, 1.0), specular = vec4(0.0), emission = vec4(0.0);
  if (!first_launch || push.tick_sample > 0u) {
    diffuse = imageLoad(images_rgba16f[history.diffuse], pixel);
    specular = imageLoad(images_rgba16f[history.specular], pixel);
    emission = imageLoad(images_rgba16f[history.emission], pixel);
  }
  if (first_launch && push.tick_sample > 0u) {
    diffuse.rgb *= 1.0 - share;
    specular.rgb *= 1.0 - share;
    emission.rgb *= 1.0 - share;
  }
  if (dropped) {
    diffuse.a = 0.0;
  } else {
    const uvec2 albedos = imageLoad(images_rg32ui[history.albedos], pixel).xy;
    const float scale = history.unit * share;
    if (albedos.x != 0u) {
      diffuse.rgb += scale * (split_.diffuse + split_.further * split_.diffuse_share) / unpackAlbedo(albedos.x);
      specular.rgb += scale * (split_.specular + split_.further * (1.0 - split_.diffuse_share)) / unpackAlbedo(albedos.y);
    }
    emission.rgb += scale * split_.emission;
  }
  imageStore(images_rgba16f[history.diffuse], pixel, vec4(stored(diffuse.rgb), diffuse.a));
  imageStore(images_rgba16f[history.specular], pixel, vec4(stored(specular.rgb), 0.0));
  if (first_launch) imageStore(images_rgba16f[history.emission], pixel, vec4(stored(emission.rgb), 0.0));
}

#endif
