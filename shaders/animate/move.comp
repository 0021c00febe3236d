#version 460
#extension GL_GOOGLE_include_directive : require
// Writes the records of what moved into the instance table, and keeps where it was for those who look back.
#define HELIO_OWN_PUSH
#include "lib/tables.glsl"
#include "shared/animation.h"
#include "shared/history.h"

layout(local_size_x = 64) in;

layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer SlotTable { uint items[]; };
layout(buffer_reference, scalar, buffer_reference_align = 8) writeonly buffer RecordTable { InstanceRecord items[]; };
layout(buffer_reference, scalar, buffer_reference_align = 8) writeonly buffer MotionTable { MotionRecord items[]; };
layout(push_constant, scalar) uniform Move { MoveConstants constants; };

void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= constants.count) return;
  const uint slot = SlotTable(constants.slots).items[i];
  if (constants.motions != 0ul)
    MotionTable(constants.motions).items[SlotTable(constants.units).items[i]].rows = InstanceTable(constants.instances).items[slot].rows;
  RecordTable(constants.instances).items[slot] = InstanceTable(constants.records).items[i];
}
