#version 460
#extension GL_GOOGLE_include_directive : require
// What the CPU decided since the last tick: together with the BLAS, which this tick's records name already.
#include "lib/lipac.glsl"

layout(local_size_x = kLipacGroup) in;

layout(buffer_reference, scalar) readonly buffer PatchTable { LipacPatch items[]; };

void main() {
  if (gl_GlobalInvocationID.x >= lipac.patch_count) return;
  const LipacPatch job = PatchTable(lipac.patches).items[gl_GlobalInvocationID.x];
  WordTable words = WordTable(lipac.words);
  if (job.action == kPatchReset) {
    words.items[job.slot] = 0u;
    WordTable(lipac.hits).items[job.slot] = 0u;
    return;
  }
  Counter c = unpackCounter(words.items[job.slot]);
  if (c.state != kStateRequested) return;  // it has changed its mind since it asked
  enter(c, kStateActive);
  words.items[job.slot] = packCounter(c);
}
