// What the passes of SVGF [Schied et al. 2017, Spatiotemporal variance-guided filtering] share. Two signals, diffuse and specular
// light without albedos, take every step together: they share the edges.
#ifndef HELIO_SVGF_SIGNALS_GLSL
#define HELIO_SVGF_SIGNALS_GLSL
#include "lib/history.glsl"
#include "lib/random.glsl"

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

// The mean over ticks of how much of the sun is seen (sunlight/sunlight.comp) takes the place of what this tick's sample found.
void keepSunlit(ivec2 pixel) {
  if (history.sunlight == 0u) return;
  const float sunlit = imageLoad(images_rg16f[history.sunlight], pixel).x, chance = randomAt(uvec2(pixel), history.tick, 2u).x;
  const uvec2 surface = imageLoad(images_rg32ui[history.surface], pixel).xy;
  imageStore(images_rg32ui[history.surface], pixel, uvec4(surface.x, withSunlit(surface.y, sunlit, chance), 0u, 0u));
}

const float kAlikeNormals = 0.9;  // cosine

// Whether a texel of the tick before shows the surface of a pixel, which was at `depth` then.
bool continuesSurface(SurfaceTexel there, SurfaceTexel here, float depth, float gradient) {
  if (there.depth == 0.0 || instanceOf(there) != instanceOf(here) || cosine(there, here) < kAlikeNormals) return false;
  return abs(there.depth - depth) <= 2.0 * gradient + 0.01 * depth;
}

// The texels of the tick before between which a pixel's point was, as far as they show its surface.
struct Look {
  ivec2 corner;
  vec2 f;       // between the corner and the texels beyond it
  float depth;  // that its surface had
};
Look lookedAt(ivec2 pixel, SurfaceTexel here, vec4 motion) {
  const vec2 at = vec2(pixel) + motion.xy, corner = floor(at);
  return Look(ivec2(corner), at - corner, here.depth + motion.z);
}
// One of the four; weight 0: it is of no use.
float tapOf(Look look, int i, SurfaceTexel here, float gradient, out ivec2 texel, out SurfaceTexel there) {
  const ivec2 offset = ivec2(i & 1, i >> 1);
  const vec2 w = mix(1.0 - look.f, look.f, vec2(offset));
  texel = look.corner + offset;
  if (w.x * w.y <= 0.0 || !inPicture(texel)) return 0.0;
  there = readSurface(history.previous_surface, texel);
  return continuesSurface(there, here, look.depth, gradient) ? w.x * w.y : 0.0;
}
// For thin things: one of the nine texels nearest; false: it is of no use.
bool besideOf(Look look, int i, SurfaceTexel here, float gradient, out ivec2 texel, out SurfaceTexel there) {
  texel = ivec2(round(vec2(look.corner) + look.f)) + ivec2(i % 3 - 1, i / 3 - 1);
  if (!inPicture(texel)) return false;
  there = readSurface(history.previous_surface, texel);
  return continuesSurface(there, here, look.depth, gradient);
}

#endif
