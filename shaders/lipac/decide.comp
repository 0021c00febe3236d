#version 460
#extension GL_GOOGLE_include_directive : require
// Feedback, third pass: what becomes of every instance, and what the CPU must do for it.
#include "lib/lipac.glsl"

layout(local_size_x = kLipacGroup) in;

layout(buffer_reference, scalar) buffer CommandTable { LipacCommand items[]; };

const uint kMarkedWeight = 4u;  // what a mirror shows needs detail, and comes first

shared uint states[kStates], changes, cycles;

void command(uint slot, uint hits) {
  StatusRef result = StatusRef(lipac.status);
  const uint place = atomicAdd(result.status.commands, 1u);
  if (place < lipac.command_capacity) CommandTable(lipac.commands).items[place] = LipacCommand(slot, hits);
}

// True: a BLAS of its own that the CPU may have brought is no longer wanted.
bool decide(inout Counter c, uint entry, uint hits, bool dropped) {
  const bool own = (entry & kOwnBlasBit) != 0u, has_blas = (entry & kHasBlasBit) != 0u;
  if (cellOf(entry) == kNoCell) return false;  // always active, or on its way
  const Hitbox hitbox = HitboxTable(lipac.cells).items[cellOf(entry)];
  if (dropped || (hitbox.word & 3u) == kStateInactive) {
    const bool let_go = own && c.state >= kStateRequested;
    if (c.state != kStateInactive) enter(c, kStateInactive);
    return let_go;
  }
  if (c.state == kStateInactive) {
    enter(c, own ? kStateOmitted : has_blas ? kStateActive : kStateRequested);
  } else if (!own) {
    return false;  // active with its hitbox, or as soon as the BLAS that it shares is there
  } else if (c.state == kStateOmitted) {
    if (hitOften(c, hits, lipac.own_activate, lipac.own_above)) enter(c, kStateRequested);
  } else if (hitSeldom(c, lipac.own_deactivate, lipac.own_below)) {
    if (isCycle(c)) {
      countCycle(c);
      atomicAdd(cycles, 1u);
    }
    enter(c, kStateOmitted);
    return true;
  }
  return false;
}

void main() {
  if (gl_LocalInvocationIndex < kStates) states[gl_LocalInvocationIndex] = 0u;
  if (gl_LocalInvocationIndex == 0u) changes = cycles = 0u;
  barrier();
  const uint index = gl_GlobalInvocationID.x;
  const uint entry = index < lipac.count ? WordTable(lipac.entries).items[index] : 0u;
  if ((entry & kThereBit) != 0u) {
    const uint slot = slotAt(index);
    WordTable words = WordTable(lipac.words), hit_table = WordTable(lipac.hits);
    const uint word = words.items[slot], counted = hit_table.items[slot];
    const bool dropped = counted == kHitDropped, own = (entry & kOwnBlasBit) != 0u;
    const uint hits = dropped ? 0u : counted & ~kHitMarked;

    Counter c = unpackCounter(word);
    const uint before = c.state;
    smoothHits(c, hits, slot);
    c.marked = !dropped && (counted & kHitMarked) != 0u;
    if (decide(c, entry, hits, dropped)) command(slot | kCommandRemove, 0u);
    const uint urgency = max(hits, c.smoothed) * (c.marked ? kMarkedWeight : 1u);
    if (c.state == kStateRequested && own) command(slot, urgency);
    // The BLAS that it shares is to be there in the next tick.
    if (c.state != before && c.state >= kStateRequested && !own) {
      const InstanceRecord instance = InstanceTable(lipac.instances).items[slot];
      needShared(instance, urgency);
    }

    const uint after = packCounter(c);
    if (after != word) words.items[slot] = after;
    if (counted != 0u) hit_table.items[slot] = 0u;
    atomicAdd(states[c.state], 1u);
    if (c.state != before) atomicAdd(changes, 1u);
  }
  barrier();
  if (gl_LocalInvocationIndex < kStates && states[gl_LocalInvocationIndex] > 0u) {
    StatusRef result = StatusRef(lipac.status);
    atomicAdd(result.status.states[gl_LocalInvocationIndex], states[gl_LocalInvocationIndex]);
  }
  if (gl_LocalInvocationIndex == 0u && changes + cycles > 0u) {
    StatusRef result = StatusRef(lipac.status);
    atomicAdd(result.status.changes, changes);
    atomicAdd(result.status.cycles, cycles);
  }
}
