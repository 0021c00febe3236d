// Looking back: where the camera and the point that it sees were in the tick before, and how what is kept of it is read.
#ifndef HELIO_HISTORY_GLSL
#define HELIO_HISTORY_GLSL
#include "lib/bindless.glsl"
#include "lib/math.glsl"
#include "lib/tables.glsl"
#include "shared/history.h"

layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer HistoryRef { HistoryConstants constants; };
#define history HistoryRef(frame.history).constants

// The largest of a 16-bit float, and a little less: what is brighter than that times white is cut.
const float kMostStored = 65000.0;
// Albedos below this are divided by it: so they are never 0, and come back exactly.
const float kLeastAlbedo = 1.0 / 255.0;

// By bits, which no compiler may assume away.
bool isNumber(vec4 v) { return all(lessThan(floatBitsToUint(v) & 0x7fffffffu, uvec4(0x7f800000u))); }

vec3 stored(vec3 v) { return clamp(v, vec3(0.0), vec3(kMostStored)); }

// Integers below 2^23 as floats: the lowest bits of 2^23 + them. Filters unpack dozens of texels a pixel, and GPUs convert slowly.
const uint kTwoTo23 = 0x4b000000u;
vec3 small(uvec3 q) { return uintBitsToFloat(q | kTwoTo23) - uintBitsToFloat(kTwoTo23); }

// ---- The surface that a pixel shows, be it in a mirror ----

// A normal in 2 x 11 bits, octahedral [Cigolle et al. 2014], and 10 bits that tell instances and their mirror images apart.
uint packSurface(vec3 normal, uint slot, bool mirrored) {
  vec2 e = normal.xy / (abs(normal.x) + abs(normal.y) + abs(normal.z));
  if (normal.z < 0.0) e = (1.0 - abs(e.yx)) * vec2(e.x >= 0.0 ? 1.0 : -1.0, e.y >= 0.0 ? 1.0 : -1.0);
  const uvec2 q = uvec2(round(clamp(0.5 + 0.5 * e, 0.0, 1.0) * 2046.0));
  return q.x | q.y << 11 | ((mirrored ? ~slot : slot) * 2654435761u >> 22) << 22;
}
const uint kNormalBits = 0x3fffffu;
vec3 surfaceNormal(uint packed_surface) {
  const vec2 e = small(uvec3(packed_surface & 2047u, packed_surface >> 11 & 2047u, 0u)).xy / 1023.0 - 1.0;
  vec3 v = vec3(e, 1.0 - abs(e.x) - abs(e.y));
  if (v.z < 0.0) v.xy = (1.0 - abs(v.yx)) * vec2(v.x >= 0.0 ? 1.0 : -1.0, v.y >= 0.0 ? 1.0 : -1.0);
  return normalize(v);
}
// Depth in metres to 16 bits, 0 where there is no surface; the sign tells what is seen in a mirror, and the 7 bits at the end how much
// of the sun reaches the surface: what shadow rays of this tick found, then their mean over ticks (sunlight/sunlight.comp).
const uint kSunlitBits = 127u;
uint packDepth(float depth, bool mirrored) { return floatBitsToUint(max(depth, 0.0)) & ~kSunlitBits | (mirrored ? 0x80000000u : 0u); }
float surfaceDepth(uint packed_depth) { return uintBitsToFloat(packed_depth & 0x7fffffffu & ~kSunlitBits); }
float surfaceSunlit(uint packed_depth) { return small(uvec3(packed_depth & kSunlitBits)).x / float(kSunlitBits); }
// `chance` in [0, 1): as packLight()'s.
uint withSunlit(uint packed_depth, float sunlit, float chance) {
  return packed_depth & ~kSunlitBits | min(uint(clamp(sunlit, 0.0, 1.0) * float(kSunlitBits) + chance), kSunlitBits);
}
bool surfaceMirrored(uint packed_depth) { return (packed_depth & 0x80000000u) != 0u; }
uint surfaceInstance(uint packed_surface) { return packed_surface >> 22; }

bool inPicture(ivec2 pixel) { return all(greaterThanEqual(pixel, ivec2(0))) && all(lessThan(pixel, ivec2(frame.width, frame.height))); }

// ---- Albedos: what is stored is what divides and what multiplies ----
// Square roots in 3 x 10 bits: so the dark ones are within 1 % too. Never 0.
uint packAlbedo(vec3 albedo) {
  const uvec3 q = uvec3(round(sqrt(clamp(albedo, vec3(kLeastAlbedo), vec3(1.0))) * 1023.0));
  return q.r | q.g << 10 | q.b << 20;
}
vec3 unpackAlbedo(uint albedo) {
  const vec3 root = vec3(albedo & 1023u, albedo >> 10 & 1023u, albedo >> 20 & 1023u) / 1023.0;
  return root * root;
}
// The two highest bits of both albedos tell how rough the specular lobe is, perceptually, in 4 bits.
uvec2 withRoughness(uvec2 albedos, float roughness) {
  const uint q = uint(round(clamp(roughness, 0.0, 1.0) * 15.0));
  return albedos | uvec2(q & 3u, q >> 2) << 30;
}
float roughnessOf(uvec2 albedos) { return float(albedos.x >> 30 | albedos.y >> 30 << 2) / 15.0; }

// ---- Light ----
// Three numbers of 9 bits with an exponent of 5 bits in common, as VK_FORMAT_E5B9G9R9_UFLOAT_PACK32: half of what 16-bit floats take.
// Rounded to nearest, or with `chance` in [0, 1) up or down so that the expected value is exact: a mean that moves by a twentieth a
// tick would come to rest a percent from its goal if its steps were rounded to nearest.
uint packLight(vec3 c, float chance) {
  c = min(c, vec3(kMostStored));
  const int exponent = max(-16, int(floatBitsToUint(max(maxComponent(c), 1e-30)) >> 23) - 127) + 1;
  // The largest may round up to the next power of two: then it is cut to what 9 bits hold.
  const uvec3 q = min(uvec3(ldexp(c, ivec3(9 - exponent)) + chance), uvec3(511u));
  return q.r | q.g << 9 | q.b << 18 | uint(exponent + 15) << 27;
}
uint packLight(vec3 c) { return packLight(c, 0.5); }
vec3 unpackLight(uint light) {
  const float scale = uintBitsToFloat((light >> 27) + 127u - 24u << 23);  // a power of two
  return small(uvec3(light & 511u, light >> 9 & 511u, light >> 18 & 511u)) * scale;
}

// Four 16-bit floats in two words.
uvec2 packHalf4(vec4 v) { return uvec2(packHalf2x16(v.xy), packHalf2x16(v.zw)); }
vec4 unpackHalf4(uvec2 v) { return vec4(unpackHalf2x16(v.x), unpackHalf2x16(v.y)); }

// ---- How many ticks a texel's mean is made of, by lobe: in quarters, kMostTicksOfLight at most ----
const float kTicksOfOne = 255.0 / 4.0;
vec2 gatheredTicks(ivec2 pixel) { return kTicksOfOne * imageLoad(images_rg8[history.samples], pixel).xy; }
void keepTicks(ivec2 pixel, vec2 ticks) { imageStore(images_rg8[history.samples], pixel, vec4(ticks / kTicksOfOne, 0.0, 0.0)); }

// Of this tick, or on its way through a denoiser: by the diffuse and the specular lobe, over their albedos.
struct LobeLight {
  vec3 rgb[2];
  vec2 deviation;  // standard deviation of the luminance; of a sample: how many paths it is the mean of, 0 where it was dropped
};
LobeLight readLight(uint light, uint deviation, ivec2 pixel) {
  const uvec2 packed_light = imageLoad(images_rg32ui[light], pixel).xy;
  LobeLight l;
  l.rgb = vec3[](unpackLight(packed_light.x), unpackLight(packed_light.y));
  l.deviation = imageLoad(images_rg16f[deviation], pixel).xy;
  return l;
}
void writeLight(uint light, uint deviation, ivec2 pixel, LobeLight l, float chance) {
  imageStore(images_rg32ui[light], pixel, uvec4(packLight(stored(l.rgb[0]), chance), packLight(stored(l.rgb[1]), chance), 0u, 0u));
  imageStore(images_rg16f[deviation], pixel, vec4(min(l.deviation, vec2(kMostStored)), 0.0, 0.0));
}
LobeLight sampledLight(ivec2 pixel) { return readLight(history.sampled, history.sampled_deviation, pixel); }

// ---- Where things are on the screen, in pixels, and their depth in metres ----
vec3 project(vec3 relative, vec3 right, vec3 up, vec3 forward, float tangent) {
  const float depth = dot(relative, forward);
  const vec2 ndc = vec2(dot(relative, right) / frame.aspect, -dot(relative, up)) / (tangent * max(depth, 1e-6));
  return vec3((0.5 + 0.5 * ndc) * vec2(frame.width, frame.height), depth);
}
vec3 projectNow(vec3 relative) { return project(relative, frame.right, frame.up, frame.forward, frame.tangent); }
vec3 projectBefore(vec3 relative) { return project(relative, history.right, history.up, history.forward, history.tangent); }

#endif
