// The push constants of the passes that estimate gradients.
#ifndef HELIO_ASVGF_GRADIENTS_GLSL
#define HELIO_ASVGF_GRADIENTS_GLSL
#define HELIO_OWN_PUSH
#include "lib/tables.glsl"
#include "shared/filter.h"

layout(push_constant, scalar) uniform Gradient { GradientConstants gradient_; };
#define frame FrameRef(gradient_.frame).constants

#include "lib/gradients.glsl"

// Where a stratum's texel of what stands in the second image of light is.
ivec2 placeOf(uint which, ivec2 stratum) { return stratum + ivec2(which & 1u, which >> 1) * ivec2(strata()); }
ivec2 middleOf(ivec2 stratum) { return min(stratum * int(kStratum) + 1, ivec2(frame.width, frame.height) - 1); }

bool inStrata(ivec2 stratum) { return all(greaterThanEqual(stratum, ivec2(0))) && all(lessThan(stratum, ivec2(strata()))); }

#endif
