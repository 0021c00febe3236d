#version 460
#extension GL_GOOGLE_include_directive : require
// Motion vectors in three dimensions: from each pixel to where its surface was in the tick before, by the motion of camera,
// instance and skin. The difference of two projections of one point, so that a world of kilometres loses nothing by it.
// What a mirror shows is followed where it seems to be: the surface behind the mirror's plane, by the motion of both.
#include "lib/camera.glsl"
#include "lib/motion.glsl"
#include "lib/seen.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

// Pixels a tick: what moves by less rests. Two projections of one point are not equal to the last bit.
const float kRest = 1e-3;

// How fast depth changes over a pixel on the triangle's plane, metres a pixel.
float depthGradient(vec3 normal, vec3 direction, float depth) {
  const vec2 size = vec2(frame.width, frame.height);
  const vec3 across = frame.right * (2.0 * frame.tangent * frame.aspect / size.x), down = frame.up * (-2.0 * frame.tangent / size.y);
  const vec3 ray = direction / dot(direction, frame.forward);
  const float facing = max(abs(dot(normal, ray)), 1e-3 * length(ray));
  return depth * max(abs(dot(normal, across)), abs(dot(normal, down))) / facing;
}

// Where a ray meets a triangle, where that point was in the tick before, and the triangle's unit normal, 0 where it has none.
struct Followed {
  vec3 now, before, normal;
};
vec3 unitOrNone(vec3 v) {
  const float size = length(v);
  return size > 0.0 ? v / size : vec3(0.0);
}
Followed follow(Hit hit, vec3 origin, vec3 direction) {
  const InstanceRecord instance = InstanceTable(frame.instances).items[hit.slot];
  const Triangle t = seenTriangle(hit, instance, origin, direction);
  const vec3 w = weights(hit);
  return Followed(t.p[0] * w.x + t.p[1] * w.y + t.p[2] * w.z, positionBefore(hit.slot, instance, t, w),
                  unitOrNone(cross(t.p[1] - t.p[0], t.p[2] - t.p[0])));
}
// The triangle's normal in the tick before.
vec3 normalBefore(Hit hit, vec3 origin, vec3 direction) {
  const InstanceRecord instance = InstanceTable(frame.instances).items[hit.slot];
  const Triangle t = seenTriangle(hit, instance, origin, direction);
  const vec3 corner = positionBefore(hit.slot, instance, t, vec3(1.0, 0.0, 0.0));
  return unitOrNone(cross(positionBefore(hit.slot, instance, t, vec3(0.0, 1.0, 0.0)) - corner,
                          positionBefore(hit.slot, instance, t, vec3(0.0, 0.0, 1.0)) - corner));
}

vec4 motionOfSky(vec3 now, vec3 before) {  // it is infinitely far
  return vec4(projectBefore(before).xy - projectNow(now).xy, 0.0, 0.0);
}

vec4 motionOf(uvec2 pixel) {
  const CameraRay ray = cameraRay(pixel);
  const vec3 direction = ray.direction;
  const Hit hit = seenHit(pixel);
  if (hit.primitive == kNothing) return motionOfSky(direction, direction);
  Followed shown = follow(hit, ray.origin, direction);
  if (kMirrors && history.split != 0u && surfaceMirrored(imageLoad(images_rg32ui[history.surface], ivec2(pixel)).y)) {
    const Hit behind = unpackHit(imageLoad(images_rg32ui[history.spare], ivec2(pixel)).xy);
    const Followed mirror = shown;
    const vec3 reflected = reflect(direction, mirror.normal), mirror_normal_before = normalBefore(hit, ray.origin, direction);
    if (behind.primitive == kNothing) return motionOfSky(direction, reflect(reflected, mirror_normal_before));
    shown = follow(behind, mirror.now, reflected);
    shown.now = mirror.now + reflect(shown.now - mirror.now, mirror.normal);
    shown.before = mirror.before + reflect(shown.before - mirror.before, mirror_normal_before);
    shown.normal = reflect(shown.normal, mirror.normal);
  }
  const vec3 now = projectNow(shown.now - frame.position), before = projectBefore(shown.before - history.position);
  const float gradient = shown.normal != vec3(0.0) ? depthGradient(shown.normal, direction, now.z) : 0.0;
  return vec4(before.z > 0.0 ? before - now : vec3(kMostStored), gradient);
}

void main() {
  const uvec2 pixel = gl_GlobalInvocationID.xy;
  if (pixel.x >= frame.width || pixel.y >= frame.height) return;
  vec4 motion = motionOf(pixel);
  if (all(lessThan(abs(motion.xy), vec2(kRest)))) motion.xy = vec2(0.0);
  // What is no number was nowhere: out of the picture.
  imageStore(images_rgba16f[history.motion], ivec2(pixel), isNumber(motion) ? clamp(motion, -kMostStored, kMostStored) : vec4(kMostStored));
}
