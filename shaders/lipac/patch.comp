#version 460
#extension GL_GOOGLE_include_directive : require
// What the CPU decided since the last tick: together with the BLAS, which this tick's records name already.
#include "lib/lipac_instance.glsl"

layout(local_size_x = kLipacGroup) in;

layout(buffer_reference, scalar) readonly buffer PatchTable { LipacPatch items[]; };

// Active with a fresh clock: it is taken to be hit as often as it takes to become active.
uint activated(uint word, uint threshold) {
  Counter c = unpackCounter(word);
  enter(c, kStateActive);
  if (threshold != kNever) c.smoothed = max(c.smoothed, min(threshold, kSmoothedMost));
  return packCounter(c);
}

void main() {
  if (gl_GlobalInvocationID.x >= lipac.patch_count) return;
  const LipacPatch job = PatchTable(lipac.patches).items[gl_GlobalInvocationID.x];
  WordTable words = WordTable(lipac.words);
  const uint word = words.items[job.slot];
  if (job.action == kPatchReset) {
    words.items[job.slot] = 0u;
    WordTable(lipac.hits).items[job.slot] = 0u;
  } else if (job.action == kPatchGrant) {
    Counter c = unpackCounter(word);
    if (c.state != kStateRequested) return;  // it has changed its mind since it asked
    enter(c, kStateActive);
    words.items[job.slot] = packCounter(c);
  } else {
    const InstanceRecord instance = InstanceTable(lipac.instances).items[job.slot];
    if (!isThere(instance)) return;
    const Placed placed = placedOf(instance);
    if (placed.cell == kNoCell) return;
    HitboxTable cells = HitboxTable(lipac.cells);
    // Neighbours may write it too: the same, since what is activated twice is as if activated once.
    cells.items[placed.cell].word = activated(cells.items[placed.cell].word, lipac.box_activate);
    if (blasOf(instance) != 0ul) words.items[job.slot] = activated(word, lipac.own_activate);
  }
}
