// What the probes have in common: their push constants, and `frame` as the library knows it.
#ifndef HELIO_TEST_PROBE_GLSL
#define HELIO_TEST_PROBE_GLSL
#define HELIO_OWN_PUSH
#include "lib/tables.glsl"
#include "probe.h"

layout(local_size_x = kProbeGroup) in;
layout(push_constant, scalar) uniform Push { ProbeConstants probe; };
#define frame FrameRef(probe.frame).constants

layout(buffer_reference, scalar) readonly buffer RandomTable { RandomNumbers items[]; };

#endif
