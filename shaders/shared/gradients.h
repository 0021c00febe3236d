// What A-SVGF keeps to see how light changes: one sample of each stratum of 3 x 3 pixels, to be shaded again in the
// next tick with its random numbers [Schied et al. 2018, Gradient estimation for real-time adaptive temporal
// filtering].
#ifndef HELIO_SHARED_GRADIENTS_H
#define HELIO_SHARED_GRADIENTS_H
#include "shared/types.h"

HELIO_SHARED_BEGIN

HELIO_CONSTANT kStratum = 3u;  // pixels along a side

HELIO_CONSTANT kPlaceShift = 28u;  // of the pixel's place in its stratum, row by row

// Of a stratum. Its random numbers are those of its pixel in the tick before.
struct GradientSample {
  uvec2 hit;  // packHit(), with the level that the mesh had
  uint mesh;  // of the instance: one that is another by now is not looked at; and the pixel's place in the stratum.
              // kNothing: no sample
  vec2 barycentrics;
  uint luminance;  // 16-bit floats: diffuse, specular; times the unit
};

// The a-trous filter of gradients: its iterations, strides 1, 2, 4, 8, 16.
HELIO_CONSTANT kGradientIterations = 5u;

// What gradients need while they are filtered stands in the second image of light, which is free then: side by side, a
// texel a stratum. Gradients are packHalf4(): diffuse and specular, each the change and the larger of two luminances.
HELIO_CONSTANT kGradientsHere = 0u;
HELIO_CONSTANT kGradientsThere = 1u;    // the filter goes to and fro
HELIO_CONSTANT kGradientSurfaces = 2u;  // the surface in the stratum's middle

HELIO_SHARED_END
#endif
