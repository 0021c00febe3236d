#version 460
#extension GL_GOOGLE_include_directive : require
// Numbers in the picture's place, for those who want to see what passes hand on (shared/history.h says which there are).
#include "lib/camera.glsl"
#include "lib/motion.glsl"
#include "lib/seen.glsl"

layout(local_size_x = 8, local_size_y = 8) in;
layout(constant_id = 47) const uint kInspect = kInspectMotion;

// Of the pixel's first surface; the origin where there is none.
vec3 position(uvec2 pixel, bool before) {
  Hit hit = seenHit(pixel);
  if (hit.primitive == kNothing) return vec3(0.0);
  const InstanceRecord instance = InstanceTable(frame.instances).items[hit.slot];
  const Triangle t = seenTriangle(hit, instance, cameraDirection(pixel));
  const vec3 w = weights(hit);
  return before ? positionBefore(hit.slot, instance, t, w) : t.p[0] * w.x + t.p[1] * w.y + t.p[2] * w.z;
}

vec3 read(uint image, ivec2 pixel) { return imageLoad(images_rgba16f[image], pixel).rgb; }

void main() {
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (!inPicture(pixel)) return;
  vec3 shown = vec3(0.0);
  if (kInspect == kInspectMotion) shown = read(history.motion, pixel);
  else if (kInspect == kInspectPosition || kInspect == kInspectBefore) shown = position(uvec2(pixel), kInspect == kInspectBefore);
  else if (kInspect == kInspectUnfiltered) {
    const uvec2 albedos = imageLoad(images_rg32ui[history.albedos], pixel).xy;
    shown = (read(history.emission, pixel) + unpackAlbedo(albedos.x) * read(history.diffuse, pixel) +
             unpackAlbedo(albedos.y) * read(history.specular, pixel)) / history.unit;
  } else if (kInspect == kInspectDiffuse) shown = read(history.filtered[0], pixel) / history.unit;
  else if (kInspect == kInspectSpecular) shown = read(history.filtered[1], pixel) / history.unit;
  else if (kInspect == kInspectSamples) shown.xy = imageLoad(images_rg16f[history.samples], pixel).xy;
  imageStore(images_rgba32f[frame.radiance], pixel, vec4(shown, 1.0));
}
