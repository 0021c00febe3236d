// Where the points of a triangle were in the tick before.
#ifndef HELIO_MOTION_GLSL
#define HELIO_MOTION_GLSL
#include "lib/history.glsl"
#include "lib/surface.glsl"

layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer UnitOfSlotTable { uint items[]; };
layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer MotionTable { MotionRecord items[]; };

// The record of the instance in the tick before; as it is now where it did not move.
InstanceRecord instanceBefore(uint slot, InstanceRecord instance) {
  if (history.moved == 0u || slot >= history.unit_of_slot_size) return instance;
  const uint unit = UnitOfSlotTable(history.unit_of_slot).items[slot];
  if (unit != kNoUnit) instance.rows = MotionTable(history.motions).items[unit].rows;
  return instance;
}

// Where the point with weights `w` of the triangle `t` of the instance was, world space. What a user moves was nowhere before:
// it is taken to have stood where it stands.
vec3 positionBefore(uint slot, InstanceRecord instance, Triangle t, vec3 w) {
  const InstanceRecord before = instanceBefore(slot, instance);
  vec3 local[3] = t.local;
  if (kDeforming && instance.deform != 0ul && history.moved != 0u) {
    DeformRecord deform = DeformRef(instance.deform).record;
    if (deform.previous_palette != 0ul) {
      deform.palette = deform.previous_palette;
      deform.weights = deform.previous_weights;
    }
    PositionTable rest = PositionTable(t.geometry.positions);
    for (int i = 0; i < 3; ++i) local[i] = deformPosition(deform, before, rest.items[t.vertices[i]], t.vertices[i]);
  }
  return toWorld(before, local[0] * w.x + local[1] * w.y + local[2] * w.z);
}

#endif
