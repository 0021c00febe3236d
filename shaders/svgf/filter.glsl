// The push constants of the passes that filter.
#ifndef HELIO_SVGF_FILTER_GLSL
#define HELIO_SVGF_FILTER_GLSL
#define HELIO_OWN_PUSH
#include "lib/tables.glsl"
#include "shared/filter.h"

layout(push_constant, scalar) uniform Filter { FilterConstants filter_; };
#define frame FrameRef(filter_.frame).constants

#include "svgf/signals.glsl"

#endif
