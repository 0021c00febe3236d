#version 460
#extension GL_GOOGLE_include_directive : require
// Writes the records of what moved into the instance table.
#define HELIO_OWN_PUSH
#include "lib/tables.glsl"
#include "shared/animation.h"

layout(local_size_x = 64) in;

layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer SlotTable { uint items[]; };
layout(buffer_reference, scalar, buffer_reference_align = 8) writeonly buffer RecordTable { InstanceRecord items[]; };
layout(push_constant, scalar) uniform Move { MoveConstants constants; };

void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= constants.count) return;
  RecordTable(constants.instances).items[SlotTable(constants.slots).items[i]] = InstanceTable(constants.records).items[i];
}
