// What a ray's payload says of the surface it met.
#ifndef HELIO_HIT_GLSL
#define HELIO_HIT_GLSL
#include "shared/frame.h"
#include "shared/scene.h"

// In the place of a geometry: a box that stands for what was culled. `slot` is the cell or the instance, barycentrics.x the
// distance.
const uint kMetOmitted = 0xfffffffeu;
const uint kMetCell = 0xffffffffu;

struct Hit {
  uint slot;
  uint geometry;    // within the mesh
  uint primitive;   // kNothing: missed
  vec2 barycentrics;
  uint level;       // of detail, of the mesh; kLevelInBlas: the one that the instance has in its BLAS
};

// Of a ray whose boxes any-hit shaders take down: the nearest cell and the nearest omitted instance before the hit.
struct CountedHit {
  Hit hit;
  uint leaves;  // the instance that the ray starts on: its bounds do not count
  uint cell;    // kNothing: none
  float cell_distance;
  uint omitted;
  float omitted_distance;
};

// What the visibility image holds of a hit.
uvec2 packHit(Hit hit) {
  if (hit.primitive == kNothing) return uvec2(0u, kNothing);
  return uvec2(hit.slot | hit.geometry << 24, hit.primitive | hit.level << kVisibilityLevelShift);
}
// Without barycentrics.
Hit unpackHit(uvec2 seen) {
  if (seen.y == kNothing) return Hit(0u, 0u, kNothing, vec2(0.0), 0u);
  return Hit(seen.x & 0xffffffu, seen.x >> 24, bitfieldExtract(seen.y, 0, int(kVisibilityLevelShift)), vec2(0.0),
             seen.y >> kVisibilityLevelShift);
}

#endif
