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

// The nearest surface within `distance`; primitive == kNothing where there is none.
Hit traceWithin(vec3 origin, vec3 direction, float distance) {
  hit_payload.primitive = kNothing;
  traceRayEXT(accelerationStructureEXT(frame.tlas), kOpaque, kMaskAll, 0, 0, kMissSurface, origin, 0.0, direction, distance, 0);
  return inSubmesh(hit_payload);
}
Hit traceSurface(vec3 origin, vec3 direction) { return traceWithin(origin, direction, kFar); }

// Nothing within `distance`?
bool traceVisible(vec3 origin, vec3 direction, float distance) {
  visible_payload = 0u;
  traceRayEXT(accelerationStructureEXT(frame.tlas),
              kOpaque | gl_RayFlagsTerminateOnFirstHitEXT | gl_RayFlagsSkipClosestHitShaderEXT, kMaskAll, 0, 0, kMissShadow,
              origin, 0.0, direction, distance, 1);
  return visible_payload != 0u;
}

// ---- Rays that count whom they meet [Kelling et al. 2024, §3.3] ----
// They meet boxes too, in a structure that holds these beside all surfaces. Whoever looks for no box does not pay for them.

layout(buffer_reference, scalar) buffer InstanceHits { uint items[]; };
layout(buffer_reference, scalar) buffer HitboxHits { Hitbox items[]; };

bool counts_ = false;  // this path does

layout(location = 2) rayPayloadEXT CountedHit counted_payload;

void countInstance(uint slot, bool marked) {
  InstanceHits counters = InstanceHits(frame.instance_hits);
  atomicAdd(counters.items[slot], frame.hit_weight);
  if (marked) atomicOr(counters.items[slot], kHitMarked);
}
void countCell(uint cell) {
  HitboxHits counters = HitboxHits(frame.hitboxes);
  atomicAdd(counters.items[cell].hits, frame.hit_weight);
}

// Boxes end the ray, which goes on from there.
Hit traceThroughBoxes(vec3 origin, vec3 direction, float distance, uint flags, uint leaves, bool marked) {
  const bool ends_at_any = (flags & gl_RayFlagsTerminateOnFirstHitEXT) != 0u;
  uint mask = counts_ ? kMaskAll | kMaskCell | kMaskOmitted : kMaskAll;
  float nearest = 0.0;
  uint sides = ends_at_any ? 0u : 2u;  // of the bounds that it starts on
  const bool any_will_do = ends_at_any && !counts_;  // nobody asks who it was
  if (any_will_do) flags |= gl_RayFlagsSkipClosestHitShaderEXT;
  for (;;) {
    hit_payload.primitive = any_will_do ? 0u : kNothing;
    traceRayEXT(accelerationStructureEXT(mask == kMaskAll ? frame.tlas : frame.counted_tlas), kOpaque | flags, mask, 0, 0, kMissSurface,
                origin, nearest, direction, distance, 0);
    const Hit hit = hit_payload;
    if (any_will_do || hit.primitive == kNothing || hit.geometry < kMetOmitted) return hit;
    // Nothing lies before the nearest hit. A shadow ray ends at any hit, so what is before this one it does not know.
    if (!ends_at_any) nearest = hit.barycentrics.x;
    if (hit.geometry == kMetCell) {
      countCell(hit.slot);
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

// Any-hit shaders take down the nearest boxes on the way.
Hit traceNotingBoxes(vec3 origin, vec3 direction, float distance, uint flags, uint leaves, bool marked) {
  counted_payload = CountedHit(Hit(0u, 0u, kNothing, vec2(0.0), 0u), leaves, kNothing, kFar, kNothing, kFar);
  const uint mask = counts_ ? kMaskAll | kMaskCell | kMaskOmitted : kMaskAll;
  traceRayEXT(accelerationStructureEXT(counts_ ? frame.counted_tlas : frame.tlas), counts_ ? flags : kOpaque | flags, mask, 0, 0,
              kMissSurface, origin, 0.0, direction, distance, 2);
  if (counted_payload.cell != kNothing) countCell(counted_payload.cell);
  if (counted_payload.omitted != kNothing) countInstance(counted_payload.omitted, marked);
  return counted_payload.hit;
}

// As the functions above, but for what is counted: whoever is met, and on the way there one cell and one omitted instance at
// most. `leaves`: the instance that the ray starts on; its bounds are not counted, or it would become active, get no hits and
// be omitted again. `marked`: this path was scattered by mirrors alone.
Hit traceCounted(vec3 origin, vec3 direction, float distance, uint flags, uint leaves, bool marked) {
  const Hit hit = kAnyHitBoxes ? traceNotingBoxes(origin, direction, distance, flags, leaves, marked)
                               : traceThroughBoxes(origin, direction, distance, flags, leaves, marked);
  if (counts_ && hit.primitive != kNothing) countInstance(hit.slot, marked);
  return (flags & gl_RayFlagsTerminateOnFirstHitEXT) != 0u ? hit : inSubmesh(hit);
}

#endif
