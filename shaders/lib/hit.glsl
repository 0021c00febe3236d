// What a ray's payload says of the surface it met.
#ifndef HELIO_HIT_GLSL
#define HELIO_HIT_GLSL
#include "shared/frame.h"

struct Hit {
  uint slot;
  uint geometry;    // within the mesh
  uint primitive;   // kNothing: missed
  vec2 barycentrics;
};

#endif
