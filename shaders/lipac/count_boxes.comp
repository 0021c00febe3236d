#version 460
#extension GL_GOOGLE_include_directive : require
// How many cells of each group want a box.
#include "lib/lipac.glsl"

layout(local_size_x = kLipacGroup) in;

shared uint wanted[kBitWords];
HELIO_GROUP_RANK(wanted)

void main() {
  const uint cell = gl_GlobalInvocationID.x;
  bool box = false;
  if (cell < cellCount()) {
    const Hitbox hitbox = HitboxTable(lipac.cells).items[cell];
    box = (hitbox.word & 3u) == kStateInactive && hitbox.lowest <= hitbox.highest;
  }
  uint total;
  groupRank_wanted(box, total);
  if (gl_LocalInvocationIndex == 0u) {
    WordTable(lipac.box_sums).items[gl_WorkGroupID.x] = total;
    StatusRef result = StatusRef(lipac.status);
    if (total > 0u) atomicAdd(result.status.boxes, total);
  }
}
