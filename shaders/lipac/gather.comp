#version 460
#extension GL_GOOGLE_include_directive : require
// Feedback, first pass: the hits of what is in the TLAS count for its hitbox too.
#include "lib/lipac.glsl"

layout(local_size_x = kLipacGroup) in;

void main() {
  const uint index = gl_GlobalInvocationID.x;
  if (index >= lipac.count) return;
  const uint entry = WordTable(lipac.entries).items[index];
  if (kindOf(entry) == kKindNone || cellOf(entry) == kNoCell) return;
  const uint hits = WordTable(lipac.hits).items[slotAt(index)];
  if (hits == 0u || hits == kHitDropped) return;
  HitboxTable cells = HitboxTable(lipac.cells);
  atomicAdd(cells.items[cellOf(entry)].hits, hits & ~kHitMarked);
}
