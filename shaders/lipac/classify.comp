#version 460
#extension GL_GOOGLE_include_directive : require
// Decides for every instance what the TLAS gets of it: itself, its bounds, or nothing but its share of its hitbox.
#include "lib/lipac_instance.glsl"

layout(local_size_x = kLipacGroup) in;

shared uint ranks[kRanks];
shared uint wanted;

// In Morton order, instances of a cell stand beside each other: a run of them asks for a cell's atomics once. By thread: its cell; by
// a run's first thread: what the run covers.
shared uint covered[kLipacGroup], lowest[kLipacGroup], highest[kLipacGroup], reaches[kLipacGroup];
shared uint firsts[kBitWords];  // a bit a thread: a run begins

bool isOpen(uint cell) { return (HitboxTable(lipac.cells).items[cell].word & 3u) == kStateActive; }

uint firstOfRun(uint thread) {
  uint word = thread / 32u, bits = firsts[word] & (0xffffffffu >> (31u - thread % 32u));
  while (bits == 0u) bits = firsts[--word];
  return 32u * word + uint(findMSB(bits));
}

// The cell's box must cover what is inactive in it: `covers`, it is.
void coverBy(bool covers, Placed placed) {
  const uint thread = gl_LocalInvocationIndex;
  covers = covers && !isOpen(placed.cell);  // which has no box
  covered[thread] = covers ? placed.cell : kNoCell;
  lowest[thread] = 0xffffffffu;
  highest[thread] = reaches[thread] = 0u;
  if (thread < kBitWords) firsts[thread] = 0u;
  barrier();
  if (thread == 0u || covered[thread - 1u] != covered[thread]) atomicOr(firsts[thread / 32u], 1u << thread % 32u);
  barrier();
  const uint first = firstOfRun(thread);
  if (covers) {
    atomicMin(lowest[first], ordered(placed.centre.y - placed.half_extent.y));
    atomicMax(highest[first], ordered(placed.centre.y + placed.half_extent.y));
    const vec2 middle = cellCorner(placed.cell) + 0.5 * float(kCellMetres);
    const vec2 beyond = abs(placed.centre.xz - middle) + placed.half_extent.xz - 0.5 * float(kCellMetres);
    atomicMax(reaches[first], floatBitsToUint(max(max(beyond.x, beyond.y), 0.0)));
  }
  barrier();
  if (thread != first || !covers) return;
  HitboxTable cells = HitboxTable(lipac.cells);
  atomicMin(cells.items[placed.cell].lowest, lowest[first]);
  atomicMax(cells.items[placed.cell].highest, highest[first]);
  atomicMax(WordTable(lipac.reaches).items[placed.cell], reaches[first]);
}

void main() {
  if (gl_LocalInvocationIndex < kRanks) ranks[gl_LocalInvocationIndex] = 0u;
  if (gl_LocalInvocationIndex == 0u) wanted = 0u;
  barrier();
  bool covers = false;
  Placed placed;
  const uint index = gl_GlobalInvocationID.x;
  if (index < lipac.count) {
    const uint slot = slotAt(index);
    const InstanceRecord instance = InstanceTable(lipac.instances).items[slot];
    uint entry = kNoCell;
    if (isThere(instance)) {
      placed = placedOf(instance);
      const bool has_blas = blasOf(instance) != 0ul, shares = sharesBlas(instance);
      const uint word = WordTable(lipac.words).items[slot];
      uint state = word & 3u, kind = kKindNone;
      // What is always active waits for its BLAS, and so does what shares one; what lost its BLAS asks for it again.
      const uint before = state;
      if (placed.cell == kNoCell || (shares && state == kStateRequested)) state = has_blas ? kStateActive : kStateRequested;
      else if (state == kStateActive && !has_blas) state = kStateRequested;
      // Its hitbox was opened since the last feedback, or it was built in an active one.
      else if (state == kStateInactive && lipac.mitigation != 0u && isOpen(placed.cell))
        state = !shares ? kStateOmitted : has_blas ? kStateActive : kStateRequested;
      if (shares && state >= kStateRequested) needShared(instance, word >> kSmoothedShift);
      if (state != before) {
        WordTable(lipac.words).items[slot] = word & ~3u | state;
        StatusRef result = StatusRef(lipac.status);
        atomicAdd(result.status.changes, 1u);
      }

      if (state == kStateActive) kind = kKindInstance;
      else if (state != kStateInactive) kind = kKindBox;
      else covers = true;
      const uint rank = placed.cell == kNoCell ? kRankMost : uint(findMSB(word >> kSmoothedShift) + 1);
      entry = placed.cell | rank << kRankShift | kind << kKindShift | kThereBit | (has_blas ? kHasBlasBit : 0u) |
              (shares ? 0u : kOwnBlasBit);
      if (kind != kKindNone) {
        atomicAdd(ranks[rank], 1u);
        atomicAdd(wanted, 1u);
      }
    }
    WordTable(lipac.entries).items[index] = entry;
  }
  coverBy(covers, placed);
  StatusRef result = StatusRef(lipac.status);
  if (gl_LocalInvocationIndex < kRanks && ranks[gl_LocalInvocationIndex] > 0u)
    atomicAdd(result.status.ranks[gl_LocalInvocationIndex], ranks[gl_LocalInvocationIndex]);
  if (gl_LocalInvocationIndex > 0u) return;
  if (wanted > 0u) atomicAdd(result.status.wanted, wanted);
  PairTable(lipac.entry_sums).items[gl_WorkGroupID.x] = uvec2(wanted, 0u);  // should all find room
}
