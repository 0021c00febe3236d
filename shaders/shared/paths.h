// The queue of paths that go on: between two vertices a path rests here, so that every launch is dense in live paths.
#ifndef HELIO_SHARED_PATHS_H
#define HELIO_SHARED_PATHS_H
#include "shared/types.h"

HELIO_SHARED_BEGIN

// A path before its next rays, one a pixel: a shadow ray, then the ray that goes on. `path_info` says which of them it
// has, and counts its rays so far; the image `radiance` has its radiance so far.
struct PathState {
  vec3 origin;
  float bsdf_pdf;  // of `direction`; 0 after mirrors
  float sky_pdf;   // with which light sampling of the sky finds `direction`; 0: it does not look
  vec3 direction;
  float cone_width;
  vec3 throughput;
  float cone_spread;
  vec3 shadow_direction;
  float shadow_distance;
  vec3 shadow_contribution;  // if nothing stands in the way
  uint diffuse_share;        // unorm8x4: of light yet to come, by the shown surface's diffuse lobe (lib/split.glsl)
  uint shadow_share;         // of what the shadow ray brings
};

// How many paths a launch has: VkTraceRaysIndirectCommandKHR, and VkDispatchIndirectCommand for the pass that finds
// those that wait after it.
struct PathLaunch {
  uint paths;
  uint trace_height;
  uint trace_depth;
  uint groups;
  uint groups_y;
  uint groups_z;
};

HELIO_CONSTANT kPathGroup = 256u;  // threads of a group of compact_paths.comp

// In path_info, until the ray is traced.
HELIO_CONSTANT kPathGoesOn = 0x80000000u;
HELIO_CONSTANT kPathShadow = 0x40000000u;
HELIO_CONSTANT kPathWaits = 0xc0000000u;      // either
HELIO_CONSTANT kPathRoughened = 0x20000000u;  // it has scattered at a diffuse or rough surface
HELIO_CONSTANT kPathInMirror = 0x10000000u;   // it has met a mirror, and not yet what the mirror shows

HELIO_SHARED_END
#endif
