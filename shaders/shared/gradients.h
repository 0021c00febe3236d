// What A-SVGF keeps to see how light changes: one sample of each stratum of 3 x 3 pixels, to be shaded again in the
// next tick with its random numbers [Schied et al. 2018, Gradient estimation for real-time adaptive temporal
// filtering].
#ifndef HELIO_SHARED_GRADIENTS_H
#define HELIO_SHARED_GRADIENTS_H
#include "shared/types.h"

HELIO_SHARED_BEGIN

HELIO_CONSTANT kStratum = 3u;  // pixels along a side

struct GradientSample {
  uint pixel;  // whose random numbers it has: x | y << 16; kNothing: there is none
  uint seed;
  uvec2 hit;  // packHit(), with the level that the mesh had
  uint mesh;  // of the instance: one that is another by now is not looked at
  vec2 barycentrics;
  vec2 luminance;  // diffuse, specular; times the unit
};

HELIO_SHARED_END
#endif
