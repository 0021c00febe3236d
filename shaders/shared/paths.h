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
  vec3 direction;
  uint cone;  // ray cone: width | spread << 16, as halves
  vec3 throughput;
  uint dimension;  // the next of its random numbers
  vec3 shadow_direction;
  float shadow_distance;
  vec3 shadow_contribution;  // if nothing stands in the way
};

// How many paths reach a vertex: VkTraceRaysIndirectCommandKHR, and VkDispatchIndirectCommand for the pass that finds
// those which go on from there.
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
HELIO_CONSTANT kPathWaits = 0xc0000000u;  // either

HELIO_SHARED_END
#endif
