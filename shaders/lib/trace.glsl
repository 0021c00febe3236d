// The rays of ray generation shaders. Iterative: hit shaders write who was hit and return [pipelines, no recursion].
#ifndef HELIO_TRACE_GLSL
#define HELIO_TRACE_GLSL
#include "lib/surface.glsl"

layout(location = 0) rayPayloadEXT Hit hit_payload;
layout(location = 1) rayPayloadEXT uint visible_payload;

const uint kMissSurface = 0;
const uint kMissShadow = 1;
// Where nothing is cut out no ray need ask.
const uint kOpaque = kAlphaMasks ? gl_RayFlagsNoneEXT : gl_RayFlagsOpaqueEXT;

// The nearest surface; primitive == kNothing where there is none.
Hit traceSurface(vec3 origin, vec3 direction) {
  hit_payload.primitive = kNothing;
  traceRayEXT(accelerationStructureEXT(frame.tlas), kOpaque, kMaskAll, 0, 0, kMissSurface, origin, 0.0, direction, kFar, 0);
  return hit_payload;
}

// Nothing within `distance`?
bool traceVisible(vec3 origin, vec3 direction, float distance) {
  visible_payload = 0u;
  traceRayEXT(accelerationStructureEXT(frame.tlas),
              kOpaque | gl_RayFlagsTerminateOnFirstHitEXT | gl_RayFlagsSkipClosestHitShaderEXT, kMaskAll, 0, 0, kMissShadow,
              origin, 0.0, direction, distance, 1);
  return visible_payload != 0u;
}

#endif
