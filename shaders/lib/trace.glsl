// The rays of ray generation shaders. Iterative: hit shaders write who was hit and return [pipelines, no recursion].
#ifndef HELIO_TRACE_GLSL
#define HELIO_TRACE_GLSL
#include "lib/surface.glsl"
#include "shared/lipac.h"

layout(location = 0) rayPayloadEXT Met met_payload;
layout(location = 1) rayPayloadEXT uint visible_payload;

const uint kMissSurface = 0;
const uint kMissShadow = 1;
const uint kMissBoxes = 2;
// Where nothing is cut out no ray need ask.
const uint kOpaque = kAlphaMasks ? gl_RayFlagsNoneEXT : gl_RayFlagsOpaqueEXT;

// The nearest surface within `distance`; primitive == kNothing where there is none.
Hit traceWithin(vec3 origin, vec3 direction, float distance) {
  met_payload.primitive = kNothing;
  traceRayEXT(accelerationStructureEXT(frame.tlas), kOpaque, kMaskAll, 0, 0, kMissSurface, origin, 0.0, direction, distance, 0);
  return inSubmesh(hitOf(met_payload));
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

layout(buffer_reference, scalar) buffer InstanceHits { uint items[]; };
layout(buffer_reference, scalar) buffer HitboxHits { Hitbox items[]; };

bool counts_ = false;  // this path does

layout(location = 2) rayPayloadEXT MetBoxes boxes_payload;

void countInstance(uint slot, bool marked) {
  InstanceHits counters = InstanceHits(frame.instance_hits);
  atomicAdd(counters.items[slot], frame.hit_weight);
  if (marked) atomicOr(counters.items[slot], kHitMarked);
}
void countCell(uint cell) {
  HitboxHits counters = HitboxHits(frame.hitboxes);
  atomicAdd(counters.items[cell].hits, frame.hit_weight);
}

void traceBoxes(vec3 origin, vec3 direction, float nearest, float farthest, uint mask) {
  traceRayEXT(accelerationStructureEXT(frame.boxes), gl_RayFlagsNoneEXT, mask, 0, 0, kMissBoxes, origin, nearest, direction, farthest, 2);
}

// A box ends the ray, which goes on from there without boxes of that kind.
void goThroughBoxes(vec3 origin, vec3 direction, float distance) {
  uint cell = kNothing, omitted = kNothing, mask = kMaskCell | kMaskOmitted;
  float nearest = 0.0;
  uint sides = 2u;  // of the bounds that it starts on
  while (mask != 0u) {
    boxes_payload.cell = boxes_payload.omitted = kNothing;
    traceBoxes(origin, direction, nearest, distance, mask);
    if (boxes_payload.cell != kNothing) {
      cell = boxes_payload.cell;
      nearest = boxes_payload.cell_distance;
      mask &= ~kMaskCell;
    } else if (boxes_payload.omitted == kNothing) {
      break;
    } else if (boxes_payload.omitted == boxes_payload.leaves && sides > 0u) {
      nearest = uintBitsToFloat(floatBitsToUint(boxes_payload.omitted_distance) + 1u);
      --sides;
    } else {
      omitted = boxes_payload.omitted;
      nearest = boxes_payload.omitted_distance;
      mask &= ~kMaskOmitted;
    }
  }
  boxes_payload.cell = cell;
  boxes_payload.omitted = omitted;
}

// Of the boxes before `distance` the nearest cell and the nearest omitted instance. `leaves`: the instance that the ray starts
// on; its bounds are not counted, or it would become active, get no hits and be omitted again.
void countBoxes(vec3 origin, vec3 direction, float distance, uint leaves, bool marked) {
  boxes_payload = MetBoxes(leaves, kNothing, distance, kNothing, distance);
  if (kAnyHitBoxes) traceBoxes(origin, direction, 0.0, distance, kMaskCell | kMaskOmitted);
  else goThroughBoxes(origin, direction, distance);
  if (boxes_payload.cell != kNothing) countCell(boxes_payload.cell);
  if (boxes_payload.omitted != kNothing && boxes_payload.omitted != leaves) countInstance(boxes_payload.omitted, marked);
}

// As traceWithin(), but whoever is met counts, and what the ray goes through on the way there. `marked`: this path was
// scattered by mirrors alone.
Hit traceCounted(vec3 origin, vec3 direction, float distance, uint leaves, bool marked) {
  const Hit hit = traceWithin(origin, direction, distance);
  if (counts_) {
    if (hit.primitive != kNothing) countInstance(hit.slot, marked);
    countBoxes(origin, direction, hit.primitive != kNothing ? met_payload.distance : distance, leaves, marked);
  }
  return hit;
}

// As traceVisible(). Light that does not arrive asks for whoever stands in its way, and for nothing else.
bool traceVisibleCounted(vec3 origin, vec3 direction, float distance, uint leaves) {
  met_payload.primitive = 0u;  // unless it misses
  const uint flags = kOpaque | gl_RayFlagsTerminateOnFirstHitEXT | (counts_ ? 0u : gl_RayFlagsSkipClosestHitShaderEXT);
  traceRayEXT(accelerationStructureEXT(frame.tlas), flags, kMaskAll, 0, 0, kMissSurface, origin, 0.0, direction, distance, 0);
  const bool visible = met_payload.primitive == kNothing;
  if (counts_) {
    if (visible) countBoxes(origin, direction, distance, leaves, false);
    else countInstance(met_payload.slot, false);
  }
  return visible;
}

#endif
