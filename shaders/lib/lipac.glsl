// Light path guided culling: its tables, the grid of hitboxes, and the counter that both hitboxes and instances are.
#ifndef HELIO_LIPAC_GLSL
#define HELIO_LIPAC_GLSL
#define HELIO_OWN_PUSH
#include "lib/shared_blas.glsl"
#include "shared/assemble.h"
#include "shared/lipac.h"

layout(buffer_reference, scalar) readonly buffer LipacTickRef { LipacTick tick; };
layout(buffer_reference, scalar) readonly buffer OrderTable { uint items[]; };
layout(buffer_reference, scalar) readonly buffer BoundsTable { MeshBounds items[]; };
layout(buffer_reference, scalar) buffer WordTable { uint items[]; };
layout(buffer_reference, scalar) buffer HitboxTable { Hitbox items[]; };
layout(buffer_reference, scalar) buffer PairTable { uvec2 items[]; };
layout(buffer_reference, scalar) buffer StatusRef { LipacStatus status; };
layout(push_constant, scalar) uniform Push { LipacPush push; };
#define lipac LipacTickRef(push.tick).tick
#include "lib/lipac_grid.glsl"

uint slotAt(uint entry) { return OrderTable(lipac.order).items[entry]; }
uint cellCount() { return lipac.grid_blocks_x * lipac.grid_blocks_z << 2u * kBlockBits; }

// ---- Floats whose order is that of integers, for atomicMin and atomicMax ----

uint ordered(float f) {
  const uint bits = floatBitsToUint(f);
  return (bits & 0x80000000u) != 0u ? ~bits : bits | 0x80000000u;
}
float unordered(uint bits) { return uintBitsToFloat((bits & 0x80000000u) != 0u ? bits & 0x7fffffffu : ~bits); }

// ---- Counters ----

struct Counter {
  uint state;
  uint above;
  uint below;
  uint cycles;
  bool marked;
  uint smoothed;
};

Counter unpackCounter(uint word) {
  return Counter(word & 3u, word >> kAboveShift & kAboveMost, word >> kBelowShift & kBelowMost, word >> kCyclesShift & 7u,
                 (word & kMarkedBit) != 0u, word >> kSmoothedShift);
}
uint packCounter(Counter c) {
  return c.state | c.above << kAboveShift | c.below << kBelowShift | c.cycles << kCyclesShift | (c.marked ? kMarkedBit : 0u) |
         c.smoothed << kSmoothedShift;
}

void enter(inout Counter c, uint state) {
  c.state = state;
  c.above = c.below = 0u;
}

// Takes in a tick's hits.
void smoothHits(inout Counter c, uint hits, uint index) {
  const uint most = min(hits, kSmoothedMost);
  c.smoothed = lipac.literal != 0u ? most : ((lipac.smoothing - 1u) * c.smoothed + most + lipac.smoothing / 2u) / lipac.smoothing;
  if (c.cycles > 0u && lipac.rests == 0u && (lipac.tick + index) % kCycleDecay == 0u) --c.cycles;
}

// Hits above `threshold` for `ticks` ticks, or above twice of it in this one. Each cycle doubles the threshold. Where nothing moves,
// a single tick has no news: it is one more sample of what the mean knows better.
bool hitOften(inout Counter c, uint hits, uint threshold, uint ticks) {
  if (threshold == kNever) return false;
  const uint raised = min(threshold << c.cycles, kSmoothedMost - kSmoothedMost / 16u);
  c.above = c.smoothed > raised ? min(c.above + 1u, kAboveMost) : 0u;
  const bool news = lipac.rests == 0u || lipac.literal != 0u;
  return c.above >= ticks || (news && hits > 2u * raised);
}

// Hits below `threshold` for `ticks` ticks. Enough of them confirm a guess.
bool hitSeldom(inout Counter c, uint threshold, uint ticks) {
  if (c.smoothed >= threshold) c.above = 0u;
  c.below = c.smoothed < threshold ? min(c.below + 1u, kBelowMost) : 0u;
  return c.below >= ticks;
}

// A guess that went wrong is none: light paths never asked for it.
bool isCycle(Counter c) { return c.state == kStateActive && c.above != kGuessed; }
void countCycle(inout Counter c) {
  if (lipac.literal == 0u) c.cycles = min(c.cycles + 1u, kCyclesMost);
}

// ---- Entries of the order ----

// The BLAS that an instance shares is needed; the one that is hit most is the most urgent.
void needShared(InstanceRecord instance, uint hits) { need(lipac.needs, recordOf(MeshTable(lipac.meshes), instance), hits + 1u); }

uint cellOf(uint entry) { return entry & kNoCell; }
uint rankOf(uint entry) { return entry >> kRankShift & kRankMost; }
uint kindOf(uint entry) { return entry >> kKindShift & 3u; }

// What takes a place in the one table takes the same in the other, behind them come cells' boxes, which all find room. Ranks from
// `sure` on fit for sure, those of the rank below as far as `room` goes.
const uint kAllFit = 0u;
void findRoom(out uint sure, out uint room) {
  StatusRef result = StatusRef(lipac.status);
  room = lipac.counted_capacity - min(result.status.boxes, lipac.counted_capacity);
  if (lipac.output_ != 0ul) room = min(room, lipac.capacity);
  sure = kAllFit;
  if (result.status.wanted <= room) return;
  for (sure = kRanks; sure > 1u && result.status.ranks[sure - 1u] <= room; --sure) room -= result.status.ranks[sure - 1u];
}

// How many threads of the group before this one have `mine`, and how many have it in all. A bit a thread: the same on every
// device, whatever its subgroups are.
const uint kBitWords = kLipacGroup / 32u;
#define HELIO_GROUP_RANK(bits)                                                  \
  uint groupRank_##bits(bool mine, out uint total) {                            \
    const uint thread = gl_LocalInvocationIndex;                                \
    if (thread < kBitWords) bits[thread] = 0u;                                  \
    barrier();                                                                  \
    if (mine) atomicOr(bits[thread / 32u], 1u << thread % 32u);                 \
    barrier();                                                                  \
    uint rank = bitCount(bits[thread / 32u] & ((1u << thread % 32u) - 1u));     \
    total = 0u;                                                                 \
    for (uint w = 0u; w < kBitWords; ++w) {                                     \
      const uint count = uint(bitCount(bits[w]));                               \
      if (w < thread / 32u) rank += count;                                      \
      total += count;                                                           \
    }                                                                           \
    return rank;                                                                \
  }

#endif
