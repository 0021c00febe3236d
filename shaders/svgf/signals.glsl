// What the passes of SVGF [Schied et al. 2017, Spatiotemporal variance-guided filtering] share. Two signals, diffuse and specular
// light without albedos, take every step together: they share the edges.
#ifndef HELIO_SVGF_SIGNALS_GLSL
#define HELIO_SVGF_SIGNALS_GLSL
#include "lib/history.glsl"

const uint kSignals = 2u;
// [Schied et al. 2017, section 4.4]
const float kSigmaDepth = 1.0;
const int kLog2SigmaNormal = 7;  // 128
const float kSigmaLuminance = 4.0;

struct SurfaceTexel {
  uint packed_surface;  // normal and instance
  float depth;          // metres; 0: nothing is there
  bool mirrored;
  float sunlit;  // share of the sun's light that reaches it, [0, 1]
};

SurfaceTexel unpackSurface(uvec2 texel) {
  return SurfaceTexel(texel.x, surfaceDepth(texel.y), surfaceMirrored(texel.y), surfaceSunlit(texel.y));
}
SurfaceTexel readSurface(uint image, ivec2 pixel) { return unpackSurface(imageLoad(images_rg32ui[image], pixel).xy); }

vec3 normalOf(SurfaceTexel t) { return surfaceNormal(t.packed_surface); }
uint instanceOf(SurfaceTexel t) { return surfaceInstance(t.packed_surface); }
// Between normals. Most neighbours have the very same one.
float cosine(SurfaceTexel a, SurfaceTexel b) {
  return ((a.packed_surface ^ b.packed_surface) & kNormalBits) == 0u ? 1.0 : dot(normalOf(a), normalOf(b));
}

// Eq. 4.
float normalWeight(SurfaceTexel a, SurfaceTexel b) {
  float alike = max(cosine(a, b), 0.0);
  for (int i = 0; i < kLog2SigmaNormal; ++i) alike *= alike;
  return alike;
}
// How far apart two depths may be, `pixels` apart on the screen [eq. 3]. `gradient`: of depth, metres a pixel. A plane's depth is
// known only as well as floats and the pixel's position in it are.
float depthTolerance(float depth, float gradient, float pixels) { return kSigmaDepth * gradient * pixels + 1e-3 * depth; }

// How alike two texels' geometry is [section 4.4].
float geometryWeight(SurfaceTexel a, SurfaceTexel b, float gradient, float pixels) {
  // Around a ball of mirror the ground that it shows lies as the ground itself does, and has another light.
  if (b.depth == 0.0 || a.mirrored != b.mirrored) return 0.0;
  return normalWeight(a, b) * exp(-abs(a.depth - b.depth) / depthTolerance(a.depth, gradient, pixels));
}

// An edge that no noise hides: by day the sun's shadows are the sharpest and darkest of the picture, and what reaches lit surfaces
// otherwise is so noisy that by luminance alone filters take the shadows for noise. `samples`: in the mean over ticks.
float sunlitTolerance(float samples) { return 0.05 + 0.25 / max(samples, 1.0); }
float sunlitWeight(SurfaceTexel a, SurfaceTexel b, float samples) { return exp(-abs(a.sunlit - b.sunlit) / sunlitTolerance(samples)); }
// Of what stands beside a point's own place: light of the sun is none of the shade's.
bool sameSun(SurfaceTexel a, SurfaceTexel b) { return abs(a.sunlit - b.sunlit) < 0.3; }
// A shadow has come to where there was none for long, or left: light from before is not to be mixed with this tick's. Penumbras are in
// between, and their means too. 1: so it is, 0: it is not.
float shadowMoved(SurfaceTexel here, float sunlit_before) { return abs(here.sunlit - sunlit_before) > 0.9 ? 1.0 : 0.0; }
// The mean over ticks takes the place of what this tick's samples found. `share`: of this tick. Where a shadow moved the mean goes half
// the way: should it have been a penumbra's rare sample, the next one will not be taken for another shadow.
void keepSunlit(ivec2 pixel, SurfaceTexel here, float before, float share, float chance) {
  const float sunlit = mix(before, here.sunlit, shadowMoved(here, before) > 0.0 ? 0.5 : share);
  const uvec2 surface = imageLoad(images_rg32ui[history.surface], pixel).xy;
  imageStore(images_rg32ui[history.surface], pixel, uvec4(surface.x, withSunlit(surface.y, sunlit, chance), 0u, 0u));
}

const float kAlikeNormals = 0.9;  // cosine

// Whether a texel of the tick before shows the surface of a pixel, which was at `depth` then.
bool continuesSurface(SurfaceTexel there, SurfaceTexel here, float depth, float gradient) {
  if (there.depth == 0.0 || instanceOf(there) != instanceOf(here) || cosine(there, here) < kAlikeNormals) return false;
  return abs(there.depth - depth) <= 2.0 * gradient + 0.01 * depth;
}

#endif
