#version 460
#extension GL_GOOGLE_include_directive : require
// Adds up the groups' counts: each becomes the sum of those before it, and the sum of all stands behind the last. One group of
// threads a volume; a thread takes neighbours.
#include "cull/cull.glsl"

layout(local_size_x = kScanGroup) in;

shared uint totals[kScanGroup][kMostLevels];

void main() {
  const uint thread = gl_LocalInvocationIndex, all = groups();
  const uint each = (all + kScanGroup - 1u) / kScanGroup;
  const uint first = min(thread * each, all), end = min(first + each, all);
  SumTable table = sums(gl_WorkGroupID.y);
  for (uint l = 0u; l < kMostLevels; ++l) {
    uint sum = 0u;
    for (uint g = first; g < end; ++g) sum += table.items[g].n[l];
    totals[thread][l] = sum;
  }
  barrier();
  if (thread < kMostLevels) {
    uint sum = 0u;
    for (uint t = 0u; t < kScanGroup; ++t) {
      const uint own = totals[t][thread];
      totals[t][thread] = sum;
      sum += own;
    }
    table.items[all].n[thread] = sum;
  }
  barrier();
  for (uint l = 0u; l < kMostLevels; ++l) {
    uint sum = totals[thread][l];
    for (uint g = first; g < end; ++g) {
      const uint own = table.items[g].n[l];
      table.items[g].n[l] = sum;
      sum += own;
    }
  }
}
