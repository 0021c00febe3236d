// What a draw of the rasteriser is given: push constants of its own.
#ifndef HELIO_PRIMARY_DRAW_GLSL
#define HELIO_PRIMARY_DRAW_GLSL
#define HELIO_OWN_PUSH
#include "lib/tables.glsl"
#include "shared/draw.h"

layout(push_constant, scalar) uniform Draw { DrawConstants draw; };
#define frame FrameRef(draw.frame).constants

#include "lib/cut_out.glsl"

#endif
