// What the passes of the recurrent blur share [Zhdan 2021, ReBLUR: A Hierarchical Recurrent Denoiser, Ray Tracing Gems II, ch. 49].
// Who lives where, pass by pass (server/render/passes/reblur.cpp):
// - pre-blur: samples -> spare; its deviations hold hit distances over the view's height at that depth from then on, and held what was
//   shown in the tick before, which goes to `stabilised`;
// - temporal accumulation: spare and the history -> the samples' place; its deviations hold how many ticks both lobes have gathered;
// - history fix: the samples' place and its mips -> spare; numbers of ticks -> `samples`;
// - blur: spare -> the samples' place; post-blur: that -> the history;
// - stabilisation: the history -> the picture; what is shown waits in the spare deviations.
#ifndef HELIO_REBLUR_GLSL
#define HELIO_REBLUR_GLSL
#include "svgf/filter.glsl"

struct Lobes {
  vec3 rgb[kSignals];
};
Lobes readLobes(uint image, ivec2 pixel) {
  const uvec2 packed_light = imageLoad(images_rg32ui[image], pixel).xy;
  return Lobes(vec3[](unpackLight(packed_light.x), unpackLight(packed_light.y)));
}
void writeLobes(uint image, ivec2 pixel, Lobes l, float chance) {
  imageStore(images_rg32ui[image], pixel, uvec4(packLight(stored(l.rgb[0]), chance), packLight(stored(l.rgb[1]), chance), 0u, 0u));
}

vec2 luminances(Lobes l) { return vec2(luminance(l.rgb[0]), luminance(l.rgb[1])); }

float roughnessAt(ivec2 pixel) { return roughnessOf(imageLoad(images_rg32ui[history.albedos], pixel).xy); }
float gradientAt(ivec2 pixel) { return imageLoad(images_rgba16f[history.motion], pixel).w; }

// How alike two surfaces are for a lobe, `pixels` apart: `sharpness` is the power of the cosine between the normals.
float lobeLikeness(SurfaceTexel a, SurfaceTexel b, float gradient, float pixels, float sharpness) {
  if (b.depth == 0.0 || a.mirrored != b.mirrored) return 0.0;
  const float tolerance = kSigmaDepth * gradient * pixels + 1e-3 * a.depth;
  return pow(max(cosine(a, b), 0.0), sharpness) * exp(-abs(a.depth - b.depth) / tolerance);
}
// Diffuse light changes slowly with the normal; a GGX lobe of alpha a is about as wide as a cosine to the power of 2 / a^2.
vec2 lobeSharpness(float roughness) { return vec2(16.0, clamp(2.0 / max(pow(roughness, 4.0), 1e-4), 16.0, 256.0)); }

// The pixel whose surface a texel of a coarser image stands for; `stride`: pixels along a texel's side.
ivec2 middleOf(ivec2 texel, int stride) { return min(texel * stride + stride / 2, ivec2(frame.width, frame.height) - 1); }

#endif
