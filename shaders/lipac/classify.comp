#version 460
#extension GL_GOOGLE_include_directive : require
// Decides for every instance what the TLAS gets of it: itself, its bounds, or nothing but its share of its hitbox.
#include "lib/lipac_instance.glsl"

layout(local_size_x = kLipacGroup) in;

shared uint ranks[kRanks];

bool isOpen(uint cell) { return (HitboxTable(lipac.cells).items[cell].word & 3u) == kStateActive; }

// The cell's box must cover what is inactive in it. Most find it large enough: a bound that is read late asks for an atomic too
// many, never for one too few.
void coverBy(Placed placed) {
  HitboxTable cells = HitboxTable(lipac.cells);
  WordTable reaches = WordTable(lipac.reaches);
  if (isOpen(placed.cell)) return;  // it has no box
  const uint lowest = ordered(placed.centre.y - placed.half_extent.y), highest = ordered(placed.centre.y + placed.half_extent.y);
  if (lowest < cells.items[placed.cell].lowest) atomicMin(cells.items[placed.cell].lowest, lowest);
  if (highest > cells.items[placed.cell].highest) atomicMax(cells.items[placed.cell].highest, highest);
  const vec2 middle = cellCorner(placed.cell) + 0.5 * float(kCellMetres);
  const vec2 beyond = abs(placed.centre.xz - middle) + placed.half_extent.xz - 0.5 * float(kCellMetres);
  const uint reach = floatBitsToUint(max(max(beyond.x, beyond.y), 0.0));
  if (reach > reaches.items[placed.cell]) atomicMax(reaches.items[placed.cell], reach);
}

void main() {
  if (gl_LocalInvocationIndex < kRanks) ranks[gl_LocalInvocationIndex] = 0u;
  barrier();
  const uint index = gl_GlobalInvocationID.x;
  if (index < lipac.count) {
    const uint slot = slotAt(index);
    const InstanceRecord instance = InstanceTable(lipac.instances).items[slot];
    uint entry = kNoCell;
    if (isThere(instance)) {
      const Placed placed = placedOf(instance);
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
      else coverBy(placed);
      const uint rank = placed.cell == kNoCell ? kRankMost : uint(findMSB(word >> kSmoothedShift) + 1);
      entry = placed.cell | rank << kRankShift | kind << kKindShift | kThereBit | (has_blas ? kHasBlasBit : 0u) |
              (shares ? 0u : kOwnBlasBit);
      if (kind != kKindNone) atomicAdd(ranks[rank], 1u);
    }
    WordTable(lipac.entries).items[index] = entry;
  }
  barrier();
  if (gl_LocalInvocationIndex < kRanks && ranks[gl_LocalInvocationIndex] > 0u) {
    StatusRef result = StatusRef(lipac.status);
    atomicAdd(result.status.ranks[gl_LocalInvocationIndex], ranks[gl_LocalInvocationIndex]);
  }
}
