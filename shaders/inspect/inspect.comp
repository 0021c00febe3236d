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

void main() {
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (!inPicture(pixel)) return;
  vec3 shown = vec3(0.0);
  if (kInspect == kInspectMotion) shown = imageLoad(images_rgba16f[history.motion], pixel).rgb;
  else if (kInspect == kInspectPosition || kInspect == kInspectBefore) shown = position(uvec2(pixel), kInspect == kInspectBefore);
  else if (kInspect == kInspectUnfiltered) {
    const uvec2 albedos = imageLoad(images_rg32ui[history.albedos], pixel).xy;
    const LobeLight light = sampledLight(pixel);
    shown = (unpackLight(imageLoad(images_r32ui[history.emission], pixel).x) + unpackAlbedo(albedos.x) * light.rgb[0] +
             unpackAlbedo(albedos.y) * light.rgb[1]) / history.unit;
  } else if (kInspect == kInspectDiffuse) shown = unpackLight(imageLoad(images_rg32ui[history.filtered], pixel).x) / history.unit;
  else if (kInspect == kInspectSpecular) shown = unpackLight(imageLoad(images_rg32ui[history.filtered], pixel).y) / history.unit;
  else if (kInspect == kInspectSamples) shown.xy = gatheredTicks(pixel);
  imageStore(images_rgba32f[frame.radiance], pixel, vec4(shown, 1.0));
}
