#version 460
#extension GL_GOOGLE_include_directive : require
// Motion vectors in three dimensions: from each pixel to where its surface was in the tick before, by the motion of camera,
// instance and skin. The difference of two projections of one point, so that a world of kilometres loses nothing by it.
#include "lib/camera.glsl"
#include "lib/motion.glsl"
#include "lib/seen.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

// How fast depth changes over a pixel on the triangle's plane, metres a pixel.
float depthGradient(vec3 normal, vec3 direction, float depth) {
  const vec2 size = vec2(frame.width, frame.height);
  const vec3 across = frame.right * (2.0 * frame.tangent * frame.aspect / size.x), down = frame.up * (-2.0 * frame.tangent / size.y);
  const vec3 ray = direction / dot(direction, frame.forward);
  const float facing = max(abs(dot(normal, ray)), 1e-3 * length(ray));
  return depth * max(abs(dot(normal, across)), abs(dot(normal, down))) / facing;
}

vec4 motionOf(uvec2 pixel) {
  const vec3 direction = cameraDirection(pixel);
  Hit hit = seenHit(pixel);
  if (hit.primitive == kNothing)  // the sky is infinitely far
    return vec4(projectBefore(direction).xy - projectNow(direction).xy, 0.0, 0.0);
  const InstanceRecord instance = InstanceTable(frame.instances).items[hit.slot];
  const Triangle t = seenTriangle(hit, instance, direction);
  const vec3 w = weights(hit);
  const vec3 now = projectNow(t.p[0] * w.x + t.p[1] * w.y + t.p[2] * w.z - frame.position);
  const vec3 before = projectBefore(positionBefore(hit.slot, instance, t, w) - history.position);
  const vec3 normal = cross(t.p[1] - t.p[0], t.p[2] - t.p[0]);
  const float size = length(normal);
  const float gradient = size > 0.0 ? depthGradient(normal / size, direction, now.z) : 0.0;
  return vec4(before.z > 0.0 ? before - now : vec3(kMostStored), gradient);
}

void main() {
  const uvec2 pixel = gl_GlobalInvocationID.xy;
  if (pixel.x >= frame.width || pixel.y >= frame.height) return;
  const vec4 motion = motionOf(pixel);
  // What is no number was nowhere: out of the picture.
  imageStore(images_rgba16f[history.motion], ivec2(pixel), isNumber(motion) ? clamp(motion, -kMostStored, kMostStored) : vec4(kMostStored));
}
