#version 460
#extension GL_GOOGLE_include_directive : require
// Feedback, second pass: which hitboxes are worth tracing.
#include "lib/lipac.glsl"

layout(local_size_x = kLipacGroup) in;

shared uint active_boxes, box_hits, cycles;

void main() {
  if (gl_LocalInvocationIndex == 0u) active_boxes = box_hits = cycles = 0u;
  barrier();
  const uint cell = gl_GlobalInvocationID.x;
  HitboxTable cells = HitboxTable(lipac.cells);
  if (cell < cellCount() && (cells.items[cell].word != 0u || cells.items[cell].hits != 0u)) {
    Counter c = unpackCounter(cells.items[cell].word);
    const uint hits = cells.items[cell].hits;
    smoothHits(c, hits, cell);
    if (c.state == kStateInactive) {
      if (hits > 0u) atomicAdd(box_hits, hits);
      if (hitOften(c, hits, lipac.box_activate, lipac.box_above)) enter(c, kStateActive);
    } else if (hitSeldom(c, lipac.box_deactivate, lipac.box_below)) {
      if (isCycle(c)) {
        countCycle(c);
        atomicAdd(cycles, 1u);
      }
      enter(c, kStateInactive);
    }
    cells.items[cell].word = packCounter(c);
    cells.items[cell].hits = 0u;
    if (c.state == kStateActive) atomicAdd(active_boxes, 1u);
  }
  barrier();
  if (gl_LocalInvocationIndex == 0u && active_boxes + box_hits + cycles > 0u) {
    StatusRef result = StatusRef(lipac.status);
    atomicAdd(result.status.active_hitboxes, active_boxes);
    atomicAdd(result.status.box_hits, box_hits);
    atomicAdd(result.status.cycles, cycles);
  }
}
