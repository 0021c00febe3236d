// Light path guided culling: where an instance is, and what rays could meet of it.
#ifndef HELIO_LIPAC_INSTANCE_GLSL
#define HELIO_LIPAC_INSTANCE_GLSL
#include "lib/lipac.glsl"
#include "lib/traced_instance.glsl"

const float kThinnest = 0.005;  // metres: half of the least that a box is thick

// World-space bounds; the hitbox of their centre, unless they are larger than two cells.
struct Placed {
  vec3 centre;
  vec3 half_extent;
  uint cell;
};

uint64_t blasOf(InstanceRecord instance) { return blasOf(MeshTable(lipac.meshes), instance); }

Placed placedOf(InstanceRecord instance) {
  const MeshBounds bounds = BoundsTable(lipac.bounds).items[instance.mesh];
  Placed placed;
  for (int i = 0; i < 3; ++i) {
    placed.centre[i] = dot(instance.rows[i], vec4(bounds.centre, 1.0));
    placed.half_extent[i] = dot(abs(instance.rows[i].xyz), bounds.half_extent);
  }
  placed.cell = max(placed.half_extent.x, placed.half_extent.z) > float(kCellMetres) ? kNoCell : cellAt(placed.centre);
  return placed;
}

// A hitbox in which something came into sight: active, with a fresh clock. However many threads do it, it is done once.
void openHitbox(uint cell) {
  if (cell == kNoCell) return;
  HitboxTable cells = HitboxTable(lipac.cells);
  const uint word = cells.items[cell].word;
  Counter c = unpackCounter(word);
  const bool opens = c.state == kStateInactive;
  c.below = 0u;
  if (opens) {
    enter(c, kStateActive);
    c.above = kGuessed;
  }
  const uint opened = packCounter(c);
  if (opened == word || atomicCompSwap(cells.items[cell].word, word, opened) != word || !opens) return;
  StatusRef result = StatusRef(lipac.status);
  atomicAdd(result.status.opened, 1u);
}

#endif
