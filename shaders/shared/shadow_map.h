// The sun's cascaded shadow map: squares across the sun's direction, ever larger ones around what the camera sees, the
// last over the whole world. One image holds them as tiles, two a row.
#ifndef HELIO_SHARED_SHADOW_MAP_H
#define HELIO_SHARED_SHADOW_MAP_H
#include "shared/types.h"

HELIO_SHARED_BEGIN

HELIO_CONSTANT kShadowCascades = 4u;
HELIO_CONSTANT kShadowTilesPerRow = 2u;  // of the image

struct ShadowCascade {
  vec3 centre;       // on a lattice of texels: so shadows stand still while the camera moves
  float half_width;  // metres
};

struct ShadowMap {
  vec3 right;  // right, up and to_sun are orthonormal
  uint image;  // reversed depth, 1 towards the sun: of the bindless textures
  vec3 up;
  uint tile;  // texels along a side of a cascade
  vec3 to_sun;
  float half_depth;  // metres that depth reaches to both sides of a cascade's centre
  uint bits;         // 1: `image` is of the bindless r32ui images, and has depth's bits
  ShadowCascade cascades[kShadowCascades];
};

// Where the sun's shadows come from.
HELIO_CONSTANT kSunShadowRays = 0u;
HELIO_CONSTANT kSunShadowRaysAndMap = 1u;  // what stands in the way is in the TLAS or in the map
HELIO_CONSTANT kSunShadowMap = 2u;

HELIO_SHARED_END
#endif
