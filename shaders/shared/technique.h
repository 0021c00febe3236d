// How light is followed through a scene: the stages of ray tracing's history [Lipp 2021, section 4.1 and table 4.1].
#ifndef HELIO_SHARED_TECHNIQUE_H
#define HELIO_SHARED_TECHNIQUE_H
#include "shared/types.h"

HELIO_SHARED_BEGIN

HELIO_CONSTANT kTechniquePathTraced = 0u;  // all light [Kajiya 1986]
HELIO_CONSTANT kTechniqueDistributed =
    1u;                                 // light of lamps, sun and sky, and what shines lobes show [Cook et al. 1984]
HELIO_CONSTANT kTechniqueWhitted = 2u;  // of points, and what is reflected sharply; without chance [Whitted 1980]

// What stands in the place of light that was scattered diffusely, where it is not followed.
HELIO_CONSTANT kAmbientNone = 0u;
HELIO_CONSTANT kAmbientConstant = 1u;  // the sky's, as if nothing stood in its way
HELIO_CONSTANT kAmbientOccluded = 2u;  // the sky's, where a ray finds nothing within a radius: ambient occlusion

// Of so many pixels one follows its path beyond the surface that it shows.
HELIO_CONSTANT kIndirectFull = 1u;
HELIO_CONSTANT kIndirectHalf = 2u;
HELIO_CONSTANT kIndirectQuarter = 4u;

// What a pixel knows of the light that its surface scatters, for neighbours to use [Stachowiak 2015, Stochastic
// screen-space reflections; Barre-Brisebois and Halen 2018, PICA PICA].
struct IndirectSample {
  uint view;       // unit vector to the viewer, octahedral
  float alpha;     // of the surface's GGX lobe; 0: it has none, or a mirror
  uint direction;  // of the ray that the path goes on with, octahedral
  float pdf;  // its density; 0: the pixel has no ray, or one that is of use to nobody else; -1: one that brings nothing
  uint light;    // packLight() of what came along the ray, times the unit
  uint weights;  // halves: f |cos| over density and albedo, of the pixel's own diffuse and specular lobe
};

HELIO_SHARED_END
#endif
