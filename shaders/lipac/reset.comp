#version 460
#extension GL_GOOGLE_include_directive : require
// Before the assembly: no hitbox holds anything, and nothing was counted.
#include "lib/lipac.glsl"

layout(local_size_x = kLipacGroup) in;

void main() {
  const uint cell = gl_GlobalInvocationID.x;
  if (cell == 0u) {
    StatusRef result = StatusRef(lipac.status);
    result.status.commands = result.status.boxes = result.status.wanted = result.status.entered = result.status.entries = result.status.dropped = 0u;
    result.status.active_hitboxes = result.status.box_hits = result.status.changes = result.status.cycles = 0u;
    result.status.opened = 0u;
    for (uint i = 0u; i < kRanks; ++i) result.status.ranks[i] = 0u;
    for (uint i = 0u; i < kStates; ++i) result.status.states[i] = 0u;
  }
  if (cell >= cellCount()) return;
  HitboxTable cells = HitboxTable(lipac.cells);
  cells.items[cell].lowest = 0xffffffffu;
  cells.items[cell].highest = 0u;
  WordTable(lipac.reaches).items[cell] = 0u;
}
