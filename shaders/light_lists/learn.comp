#version 460
#extension GL_GOOGLE_include_directive : require
// A cell's list of lamps learns from the shadow rays of the tick: a lamp counts for as much as of its light arrived lately, lamps
// that were found hidden go to the end, and the least of them makes room for one beyond the list that was seen. Whatever the list
// says, lib/lights.glsl gives every lamp of the world a share, so that nothing becomes biased and what is uncovered is found again.
#include "lib/light_candidates.glsl"

layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Lists { LightListConstants lists; };

layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Cells { LightCell items[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Memories { LightMemory items[]; };

const uint kNowhere = 0xffffffffu;
const uint kMemory = 256u;       // shadow rays that are remembered of a lamp: older ones fade
const uint kEnough = 16u;        // to say that a lamp is hidden
const float kHidden = 1.0 / 64.0;
const float kLeastShare = 1.0 / 16.0;  // of what a lamp would send, by which it stays in its list

struct Entry {
  uint slot, tried, seen;
  float weight;
};

// Part of the lamp's light that arrives, about: nobody is hidden before anybody looked.
float visibility(Entry e) { return float(e.seen + 1u) / float(e.tried + 1u); }
float value(Entry e) { return e.weight * max(visibility(e), kLeastShare); }
bool found(Entry e) { return e.tried < kEnough || visibility(e) >= kHidden; }
// Found ones first, then by what they bring; slots tell equals apart, so that the order is always the same.
bool before(Entry a, Entry b) {
  if (found(a) != found(b)) return found(a);
  const float va = value(a), vb = value(b);
  return va != vb ? va > vb : a.slot < b.slot;
}

void main() {
  const uint cell = gl_GlobalInvocationID.x;
  if (cell >= lists.cells) return;
  Cells learned = Cells(lists.learned);
  Memories memories = Memories(lists.memories);
  Entry entries[kLightsPerCell];
  uint count;
  uint candidate = 0u;
  if (lists.reset != 0u) {
    const LightCell listed = Cells(lists.fixed_cells).items[cell];
    count = listed.count;
    float below = 0.0;
    for (uint i = 0u; i < count; ++i) {
      entries[i] = Entry(listed.slots[i], 0u, 0u, (listed.cdf[i] - below) * listed.irradiance);
      below = listed.cdf[i];
    }
  } else {
    count = learned.items[cell].count;
    candidate = memories.items[cell].candidate;
    bool told = candidate != 0u;
    for (uint i = 0u; i < count; ++i) {
      entries[i] = Entry(learned.items[cell].slots[i], memories.items[cell].tried[i], memories.items[cell].seen[i], memories.items[cell].weights[i]);
      told = told || entries[i].tried != 0u;
    }
    if (!told) return;
  }

  // Fade, and sort by insertion.
  for (uint i = 0u; i < count; ++i) {
    Entry e = entries[i];
    while (e.tried > kMemory) {
      e.tried /= 2u;
      e.seen /= 2u;
    }
    uint place = i;
    for (; place > 0u && before(e, entries[place - 1u]); --place) entries[place] = entries[place - 1u];
    entries[place] = e;
  }
  if (candidate != 0u) {
    const Entry e = Entry(candidateSlot(candidate), 0u, 0u, candidateIrradiance(candidate));
    uint place = count;
    if (count == kLightsPerCell) place = value(entries[count - 1u]) < value(e) ? count - 1u : kNowhere;
    else ++count;
    if (place != kNowhere) {
      for (; place > 0u && before(e, entries[place - 1u]); --place) entries[place] = entries[place - 1u];
      entries[place] = e;
    }
  }

  float sum = 0.0, below = 0.0;
  uint seen_first = 0u;
  for (uint i = 0u; i < count; ++i) {
    sum += value(entries[i]);
    if (found(entries[i])) ++seen_first;
  }
  learned.items[cell].count = count;
  learned.items[cell].found = seen_first;
  learned.items[cell].irradiance = sum;
  memories.items[cell].candidate = 0u;
  for (uint i = 0u; i < count; ++i) {
    below += value(entries[i]);
    learned.items[cell].slots[i] = entries[i].slot;
    learned.items[cell].cdf[i] = i + 1u == count ? 1.0 : below / sum;
    memories.items[cell].tried[i] = entries[i].tried;
    memories.items[cell].seen[i] = entries[i].seen;
    memories.items[cell].weights[i] = entries[i].weight;
  }
}
