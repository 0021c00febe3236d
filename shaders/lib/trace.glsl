// The rays of ray generation shaders. Iterative: hit shaders write who was hit and return [pipelines, no recursion].
#ifndef HELIO_TRACE_GLSL
#define HELIO_TRACE_GLSL
#include "lib/surface.glsl"
#include "shared/lipac.h"

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

// ---- Rays that count whom they meet [Kelling et al. 2024, §3.3] ----

layout(buffer_reference, scalar) buffer InstanceHits { uint items[]; };
layout(buffer_reference, scalar) buffer HitboxHits { Hitbox items[]; };

bool counts_ = false;  // this path does

void countInstance(uint slot, bool marked) {
  InstanceHits counters = InstanceHits(frame.instance_hits);
  atomicAdd(counters.items[slot], frame.hit_weight);
  if (marked) atomicOr(counters.items[slot], kHitMarked);
}

// As the functions above, but for what is counted: whoever is met, and on the way there one cell and one omitted instance at
// most. `leaves`: the instance that the ray starts on; its bounds are not counted, or it would become active, get no hits and
// be omitted again. `marked`: this path was scattered by mirrors alone.
Hit traceCounted(vec3 origin, vec3 direction, float distance, uint flags, uint leaves, bool marked) {
  const bool ends_at_any = (flags & gl_RayFlagsTerminateOnFirstHitEXT) != 0u;
  uint mask = counts_ ? kMaskAll | kMaskCell | kMaskOmitted : kMaskAll;
  float nearest = 0.0;
  uint sides = ends_at_any ? 0u : 2u;  // of the bounds that it starts on
  for (;;) {
    hit_payload.primitive = kNothing;
    traceRayEXT(accelerationStructureEXT(frame.tlas), kOpaque | flags, mask, 0, 0, kMissSurface, origin, nearest, direction, distance, 0);
    const Hit hit = hit_payload;
    if (hit.primitive == kNothing) return hit;
    if (hit.geometry < kMetOmitted) {
      if (counts_) countInstance(hit.slot, marked);
      return hit;
    }
    // Nothing lies before the nearest hit. A shadow ray ends at any hit, so what is before this one it does not know.
    if (!ends_at_any) nearest = hit.barycentrics.x;
    if (hit.geometry == kMetCell) {
      HitboxHits counters = HitboxHits(frame.hitboxes);
      atomicAdd(counters.items[hit.slot].hits, frame.hit_weight);
      mask &= ~kMaskCell;
    } else if (hit.slot == leaves && sides > 0u) {
      nearest = uintBitsToFloat(floatBitsToUint(nearest) + 1u);
      --sides;
    } else {
      if (hit.slot != leaves) countInstance(hit.slot, marked);
      mask &= ~kMaskOmitted;
    }
  }
}

#endif
