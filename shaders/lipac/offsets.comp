#version 460
#extension GL_GOOGLE_include_directive : require
// Exclusive prefix sums over the groups, in one group of threads: each takes a run of sums, then the runs' totals are scanned
// [Hillis, Steele 1986].
#include "lib/lipac.glsl"

layout(local_size_x = kLipacScanGroup) in;

shared uvec2 totals[kLipacScanGroup];

// In: this thread's total; out: the sum of those before it. `all`: the sum of all.
uvec2 scanTotals(uvec2 mine, out uvec2 all) {
  const uint thread = gl_LocalInvocationIndex;
  barrier();
  totals[thread] = mine;
  barrier();
  for (uint step = 1u; step < kLipacScanGroup; step *= 2u) {
    const uvec2 before = thread >= step ? totals[thread - step] : uvec2(0u);
    barrier();
    totals[thread] += before;
    barrier();
  }
  all = totals[kLipacScanGroup - 1u];
  return totals[thread] - mine;
}

void main() {
  const uint thread = gl_LocalInvocationIndex;
  PairTable entries = PairTable(lipac.entry_sums);
  WordTable boxes = WordTable(lipac.box_sums);
  const uint entry_groups = (lipac.count + kLipacGroup - 1u) / kLipacGroup;
  const uint box_groups = (cellCount() + kLipacGroup - 1u) / kLipacGroup;
  const uint entry_run = (entry_groups + kLipacScanGroup - 1u) / kLipacScanGroup, box_run = (box_groups + kLipacScanGroup - 1u) / kLipacScanGroup;

  uvec2 all_entries, all_boxes, sum = uvec2(0u);
  const uint entry_end = min((thread + 1u) * entry_run, entry_groups), box_end = min((thread + 1u) * box_run, box_groups);
  for (uint i = thread * entry_run; i < entry_end; ++i) sum += entries.items[i];
  sum = scanTotals(sum, all_entries);
  for (uint i = thread * entry_run; i < entry_end; ++i) {
    const uvec2 group = entries.items[i];
    entries.items[i] = sum;
    sum += group;
  }

  uint from, room;
  findRoom(from, room);
  const uint entered = all_entries.x + min(all_entries.y, room);
  // Boxes follow the instances.
  sum = uvec2(0u);
  for (uint i = thread * box_run; i < box_end; ++i) sum.x += boxes.items[i];
  sum = scanTotals(sum, all_boxes) + uvec2(entered, 0u);
  for (uint i = thread * box_run; i < box_end; ++i) {
    const uint group = boxes.items[i];
    boxes.items[i] = sum.x;
    sum.x += group;
  }

  if (thread == 0u) {
    StatusRef result = StatusRef(lipac.status);
    const uint shown = min(all_boxes.x, lipac.counted_capacity - entered);
    result.status.entered = entered;
    result.status.entries = entered + shown;
    result.status.dropped = all_boxes.x + result.status.wanted - entered - shown;
  }
}
