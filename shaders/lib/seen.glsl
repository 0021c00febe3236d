// What a pixel of the visibility image sees.
#ifndef HELIO_SEEN_GLSL
#define HELIO_SEEN_GLSL
#include "lib/bindless.glsl"
#include "lib/surface.glsl"

// The instance, geometry and primitive; primitive == kNothing where nothing is seen. Barycentrics are left out.
Hit seenHit(uvec2 pixel) {
  Hit hit = unpackHit(imageLoad(images_rg32ui[frame.visibility], ivec2(pixel)).xy);
  hit.barycentrics = vec2(1.0 / 3.0);
  return hit;
}

// Its triangle, and where a ray meets it: the camera's, or one that a mirror sends on.
Triangle seenTriangle(inout Hit hit, InstanceRecord instance, vec3 origin, vec3 direction) {
  const MeshRecord mesh = meshLevel(instance, hit.level);
  const Triangle t = loadTriangle(instance, mesh.first_geometry + hit.geometry, hit.primitive);
  hit.barycentrics = intersectPlane(t, origin, direction);
  return t;
}

Triangle seenTriangle(inout Hit hit, InstanceRecord instance, vec3 direction) { return seenTriangle(hit, instance, frame.position, direction); }

vec3 weights(Hit hit) { return vec3(1.0 - hit.barycentrics.x - hit.barycentrics.y, hit.barycentrics); }

#endif
