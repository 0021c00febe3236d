// Disks on the tangent plane of what a pixel shows, as seen by the camera.
#ifndef HELIO_REBLUR_DISK_GLSL
#define HELIO_REBLUR_DISK_GLSL
#include "svgf/filter.glsl"

struct TangentDisk {
  vec2 middle;          // pixels
  vec3 position;        // of the middle, relative to the camera
  vec3 across, along;   // one pixel's width in the middle of the disk, metres
  bool on_screen;       // what a mirror shows lies in no plane that the camera knows: a disk of the screen
};

TangentDisk tangentDisk(ivec2 pixel, vec3 normal, float depth, bool mirrored) {
  TangentDisk disk;
  disk.middle = vec2(pixel) + 0.5;
  const vec2 ndc = 2.0 * disk.middle / vec2(frame.width, frame.height) - 1.0;
  disk.position = depth * (frame.forward + frame.tangent * (ndc.x * frame.aspect * frame.right - ndc.y * frame.up));
  const mat3 plane = basis(normal);
  const float metres = 2.0 * frame.tangent * depth / float(frame.height);
  disk.across = metres * plane[0];
  disk.along = metres * plane[1];
  disk.on_screen = mirrored;
  return disk;
}

// Where a point of the disk is on the screen; `offset`: pixels' widths from its middle.
vec2 diskPixel(TangentDisk disk, vec2 offset) {
  if (disk.on_screen) return disk.middle + offset;
  const vec3 on_screen = projectNow(disk.position + offset.x * disk.across + offset.y * disk.along);
  return on_screen.z > 0.0 ? on_screen.xy : vec2(-1.0);
}

#endif
