// The push constants of the passes that estimate gradients.
#ifndef HELIO_ASVGF_GRADIENTS_GLSL
#define HELIO_ASVGF_GRADIENTS_GLSL
#define HELIO_OWN_PUSH
#include "lib/tables.glsl"
#include "shared/filter.h"

layout(push_constant, scalar) uniform Gradient { GradientConstants gradient_; };
#define frame FrameRef(gradient_.frame).constants

#include "lib/gradients.glsl"

bool inStrata(ivec2 stratum) { return all(greaterThanEqual(stratum, ivec2(0))) && all(lessThan(stratum, ivec2(strata()))); }

#endif
