// The picture that a denoiser makes of its light.
#ifndef HELIO_SVGF_PICTURE_GLSL
#define HELIO_SVGF_PICTURE_GLSL
#include "svgf/filter.glsl"

// Of a picture that stands still, the plain mean takes over between so many samples: in the end it is what is right.
const float kMeanFrom = 64.0, kMeanAlone = 1024.0;
const float kErrorEpsilon = 0.01;  // of relative errors: server/render/metrics/image.h

// Albedos and emission come back.
vec3 modulated(ivec2 pixel, LobeLight light) {
  const uvec2 albedos = imageLoad(images_rg32ui[history.albedos], pixel).xy;
  vec3 radiance = unpackLight(imageLoad(images_r32ui[history.emission], pixel).x);
  if (albedos.x != 0u) radiance += unpackAlbedo(albedos.x) * light.rgb[0] + unpackAlbedo(albedos.y) * light.rgb[1];
  return radiance / history.unit;
}

// Of radiance, per channel, where the lobes' luminances deviate so.
vec3 modulatedVariance(ivec2 pixel, vec2 deviation) {
  const uvec2 albedos = imageLoad(images_rg32ui[history.albedos], pixel).xy;
  if (albedos.x == 0u) return vec3(0.0);
  const vec3 diffuse = unpackAlbedo(albedos.x) * deviation.x, specular = unpackAlbedo(albedos.y) * deviation.y;
  return (diffuse * diffuse + specular * specular) / (history.unit * history.unit);
}

void showPicture(ivec2 pixel, LobeLight light) {
  vec3 radiance = modulated(pixel, light);
  vec3 variance = modulatedVariance(pixel, light.deviation);
  if (float(filter_.accumulated) > kMeanFrom) {
    const float share = smoothstep(log2(kMeanFrom), log2(kMeanAlone), log2(float(filter_.accumulated)));
    radiance = mix(radiance, imageLoad(images_rgba32f[filter_.mean], pixel).rgb, share);
    // Not every denoiser knows how noisy a sample is.
    const vec2 of_a_sample = history.moments != 0u ? unpackHalf4(imageLoad(images_rg32ui[history.moments], pixel).xy).yw : vec2(0.0);
    const vec3 of_the_mean = modulatedVariance(pixel, of_a_sample) / float(filter_.accumulated);
    variance = (1.0 - share) * (1.0 - share) * variance + share * share * of_the_mean;
  }
  // Beside the light: how noisy it is, as errors are counted.
  const vec3 relative = variance / (radiance * radiance + kErrorEpsilon);
  imageStore(images_rgba32f[frame.radiance], pixel, vec4(radiance, dot(relative, vec3(1.0 / 3.0))));
}

#endif
