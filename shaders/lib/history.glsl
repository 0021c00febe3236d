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

// ---- The first surface of a pixel ----

// A normal in 2 x 11 bits, octahedral [Cigolle et al. 2014], and 10 bits that tell instances apart.
uint packSurface(vec3 normal, uint slot) {
  vec2 e = normal.xy / (abs(normal.x) + abs(normal.y) + abs(normal.z));
  if (normal.z < 0.0) e = (1.0 - abs(e.yx)) * vec2(e.x >= 0.0 ? 1.0 : -1.0, e.y >= 0.0 ? 1.0 : -1.0);
  const uvec2 q = uvec2(round(clamp(0.5 + 0.5 * e, 0.0, 1.0) * 2046.0));
  return q.x | q.y << 11 | (slot * 2654435761u >> 22) << 22;
}
vec3 surfaceNormal(uint packed_surface) {
  const vec2 e = vec2(packed_surface & 2047u, packed_surface >> 11 & 2047u) / 1023.0 - 1.0;
  vec3 v = vec3(e, 1.0 - abs(e.x) - abs(e.y));
  if (v.z < 0.0) v.xy = (1.0 - abs(v.yx)) * vec2(v.x >= 0.0 ? 1.0 : -1.0, v.y >= 0.0 ? 1.0 : -1.0);
  return normalize(v);
}
uint surfaceInstance(uint packed_surface) { return packed_surface >> 22; }

bool inPicture(ivec2 pixel) { return all(greaterThanEqual(pixel, ivec2(0))) && all(lessThan(pixel, ivec2(frame.width, frame.height))); }

// ---- Albedos: what is stored is what divides and what multiplies ----
// Square roots in 3 x 10 bits: so the dark ones are within 1 % too. Never 0.
uint packAlbedo(vec3 albedo) {
  const uvec3 q = uvec3(round(sqrt(clamp(albedo, vec3(kLeastAlbedo), vec3(1.0))) * 1023.0));
  return q.r | q.g << 10 | q.b << 20;
}
vec3 unpackAlbedo(uint albedo) {
  const vec3 root = vec3(albedo & 1023u, albedo >> 10 & 1023u, albedo >> 20) / 1023.0;
  return root * root;
}

// ---- Where things are on the screen, in pixels, and their depth in metres ----
vec3 project(vec3 relative, vec3 right, vec3 up, vec3 forward, float tangent) {
  const float depth = dot(relative, forward);
  const vec2 ndc = vec2(dot(relative, right) / frame.aspect, -dot(relative, up)) / (tangent * max(depth, 1e-6));
  return vec3((0.5 + 0.5 * ndc) * vec2(frame.width, frame.height), depth);
}
vec3 projectNow(vec3 relative) { return project(relative, frame.right, frame.up, frame.forward, frame.tangent); }
vec3 projectBefore(vec3 relative) { return project(relative, history.right, history.up, history.forward, history.tangent); }

#endif
