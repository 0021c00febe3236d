#version 460
#extension GL_GOOGLE_include_directive : require
// Forward projection [Schied et al. 2018, section 4.1]: each sample of the tick before claims the stratum in which its point is seen
// now. Of several the one with the largest claim wins, whatever the order.
#include "asvgf/gradients.glsl"
#include "lib/seen.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

const float kSameDepth = 0.02;  // relative

// Whether what the pixel sees is the sample's surface, at about its depth.
bool sees(uvec2 pixel, Hit hit, float depth) {
  Hit there = unpackHit(imageLoad(images_rg32ui[frame.visibility], ivec2(pixel)).xy);
  if (there.primitive == kNothing || there.slot != hit.slot || there.geometry != hit.geometry) return false;
  const vec2 ndc = 2.0 * (vec2(pixel) + 0.5) / vec2(frame.width, frame.height) - 1.0;
  const vec3 direction = frame.forward + frame.tangent * (ndc.x * frame.aspect * frame.right - ndc.y * frame.up);
  const Triangle t = seenTriangle(there, InstanceTable(frame.instances).items[there.slot], frame.position, direction);
  const vec3 w = weights(there);
  const float seen = dot(t.p[0] * w.x + t.p[1] * w.y + t.p[2] * w.z - frame.position, frame.forward);
  return abs(seen - depth) < kSameDepth * depth;
}

void main() {
  const uvec2 stratum = gl_GlobalInvocationID.xy;
  if (!inStrata(ivec2(stratum)) || history.reshades == 0u) return;
  const uint index = stratumIndex(stratum);
  const KeptSample again = keptSample(index);
  if (!again.there) return;
  const Hit hit = again.hit;
  const InstanceRecord instance = InstanceTable(frame.instances).items[hit.slot];
  if (instance.mesh != again.mesh) return;
  const Triangle t = loadTriangle(instance, meshLevel(instance, hit.level).first_geometry + hit.geometry, hit.primitive);
  const vec2 b = hit.barycentrics;
  const vec3 now = projectNow(t.p[0] * (1.0 - b.x - b.y) + t.p[1] * b.x + t.p[2] * b.y - frame.position);
  if (!(now.z > 0.0) || any(lessThan(now.xy, vec2(0.0))) || any(greaterThanEqual(now.xy, vec2(frame.width, frame.height)))) return;
  const uvec2 pixel = uvec2(now.xy);
  if (sees(pixel, hit, now.z)) imageAtomicMax(images_r32ui[history.claims], ivec2(pixel / kStratum), packClaim(index, pixel));
}
