#version 460
#extension GL_GOOGLE_include_directive : require
#define HELIO_OWN_PUSH
#include "lib/tables.glsl"
#include "shared/draw.h"

layout(push_constant, scalar) uniform Draw { DrawConstants draw; };

layout(location = 0) flat in uint slot;
layout(location = 0) out uvec2 visibility;

void main() { visibility = uvec2(slot | draw.geometry << 24, uint(gl_PrimitiveID)); }
