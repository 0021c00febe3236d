#version 460
#extension GL_GOOGLE_include_directive : require
// What the CPU decided since the last tick: together with the BLAS, which this tick's records name already.
#include "lib/lipac_instance.glsl"

layout(local_size_x = kLipacGroup) in;

layout(buffer_reference, scalar) readonly buffer PatchTable { LipacPatch items[]; };

void main() {
  if (gl_GlobalInvocationID.x >= lipac.patch_count) return;
  const LipacPatch job = PatchTable(lipac.patches).items[gl_GlobalInvocationID.x];
  WordTable words = WordTable(lipac.words);
  if (job.action == kPatchReset || job.action == kPatchShowAnew) {
    words.items[job.slot] = 0u;
    WordTable(lipac.hits).items[job.slot] = 0u;
    if (job.action == kPatchReset) return;
  }
  if (job.action != kPatchGrant) {
    const InstanceRecord instance = InstanceTable(lipac.instances).items[job.slot];
    if (isThere(instance)) openHitbox(placedOf(instance).cell);
    if (job.action == kPatchOpen) return;
  }
  Counter c = unpackCounter(words.items[job.slot]);
  const bool shown = job.action == kPatchShow;
  if (c.state == kStateActive || (!shown && c.state != kStateRequested)) return;  // it has changed its mind since it asked
  enter(c, kStateActive);
  if (shown) c.above = kGuessed;
  words.items[job.slot] = packCounter(c);
}
