// The picture that a denoiser makes of its light.
#ifndef HELIO_SVGF_PICTURE_GLSL
#define HELIO_SVGF_PICTURE_GLSL
#include "svgf/filter.glsl"

// Of a picture that stands still, the plain mean takes over between so many samples: in the end it is what is right.
const float kMeanFrom = 64.0, kMeanAlone = 1024.0;

// Albedos and emission come back.
vec3 modulated(ivec2 pixel, LobeLight light) {
  const uvec2 albedos = imageLoad(images_rg32ui[history.albedos], pixel).xy;
  vec3 radiance = unpackLight(imageLoad(images_r32ui[history.emission], pixel).x);
  if (albedos.x != 0u) radiance += unpackAlbedo(albedos.x) * light.rgb[0] + unpackAlbedo(albedos.y) * light.rgb[1];
  return radiance / history.unit;
}

void showPicture(ivec2 pixel, LobeLight light) {
  vec3 radiance = modulated(pixel, light);
  if (float(filter_.accumulated) > kMeanFrom) {
    const float share = smoothstep(log2(kMeanFrom), log2(kMeanAlone), log2(float(filter_.accumulated)));
    radiance = mix(radiance, imageLoad(images_rgba32f[filter_.mean], pixel).rgb, share);
  }
  imageStore(images_rgba32f[frame.radiance], pixel, vec4(radiance, 1.0));
}

#endif
