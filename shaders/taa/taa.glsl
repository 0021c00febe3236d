#ifndef HELIO_TAA_GLSL
#define HELIO_TAA_GLSL
#define HELIO_OWN_PUSH
#include "lib/tables.glsl"
#include "shared/taa.h"

layout(push_constant, scalar) uniform Taa { TaaConstants taa; };
#define frame FrameRef(taa.frame).constants

#include "lib/history.glsl"

#endif
