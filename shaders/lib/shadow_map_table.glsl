#ifndef HELIO_SHADOW_MAP_TABLE_GLSL
#define HELIO_SHADOW_MAP_TABLE_GLSL
#include "shared/shadow_map.h"

layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer ShadowMapRef { ShadowMap map; };

#endif
