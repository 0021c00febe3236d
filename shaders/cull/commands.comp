#version 460
#extension GL_GOOGLE_include_directive : require
// The draws of what is there to draw, without gaps and in the order of their records; one group of threads a volume and kind
// (without a mask, with one). A thread takes neighbours.
#include "cull/cull.glsl"

#include "shared/raster.h"

layout(local_size_x = kScanGroup) in;

layout(buffer_reference, scalar, buffer_reference_align = 4) buffer CommandTable { DrawCommand items[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer CountTable { DrawCounts items[]; };

shared uvec2 totals[kScanGroup];  // commands, triangles

uint instancesOf(DrawRecord draw, out uint first) {
  first = 0u;
  if (Words(cull.mesh_first).items[draw.mesh] == Words(cull.mesh_first).items[draw.mesh + 1u]) return 0u;
  const DrawRange range = ranges(gl_WorkGroupID.y).items[draw.mesh];
  first = range.first[draw.level];
  return range.end[draw.level] - first;
}

void main() {
  const uint thread = gl_LocalInvocationIndex, volume = gl_WorkGroupID.y;
  const bool masked = gl_WorkGroupID.x == 1u;
  const uint begin = masked ? cull.solid_draws : 0u, all = masked ? cull.draw_count : cull.solid_draws;
  const uint each = (all - begin + kScanGroup - 1u) / kScanGroup;
  const uint from = min(begin + thread * each, all), to = min(from + each, all);
  uvec2 total = uvec2(0u);
  uint first;
  for (uint d = from; d < to; ++d) {
    const DrawRecord draw = DrawTable(cull.draws).items[d];
    const uint instances = instancesOf(draw, first);
    if (instances > 0u) total += uvec2(1u, instances * (draw.index_count / 3u));
  }
  totals[thread] = total;
  barrier();
  uvec2 at = uvec2(begin, 0u), sum = uvec2(0u);
  for (uint t = 0u; t < kScanGroup; ++t) {
    if (t < thread) at += totals[t];
    sum += totals[t];
  }
  const uint64_t table_bytes = uint64_t(kCommandTableBytes) * cull.draw_count, table = cull.commands + table_bytes * volume;
  CommandTable commands = CommandTable(table);
  Words records = Words(table + uint64_t(kCommandBytes) * cull.draw_count);
  Words triangles = Words(table + uint64_t(kCommandBytes + 4u) * cull.draw_count);
  for (uint d = from; d < to; ++d) {
    const DrawRecord draw = DrawTable(cull.draws).items[d];
    const uint instances = instancesOf(draw, first);
    if (instances == 0u) continue;
    commands.items[at.x] = DrawCommand(draw.index_count, instances, draw.first_index, 0, first);
    records.items[at.x] = d;
    triangles.items[at.x] = at.y;
    at += uvec2(1u, instances * (draw.index_count / 3u));
  }
  if (thread == 0u) {
    CountTable counts = CountTable(cull.commands + table_bytes * gl_NumWorkGroups.y);
    const uint groups = (sum.y + kTriangleGroup - 1u) / kTriangleGroup;
    const uint sizes[3] = uint[](min(groups, kMostGroupsPerRow), (groups + kMostGroupsPerRow - 1u) / kMostGroupsPerRow, 1u);
    if (masked) {
      counts.items[volume].masked = sum.x;
      counts.items[volume].masked_triangles = sum.y;
      counts.items[volume].masked_groups = sizes;
    } else {
      counts.items[volume].solid = sum.x;
      counts.items[volume].solid_triangles = sum.y;
      counts.items[volume].solid_groups = sizes;
    }
    atomicAdd(counts.items[volume].triangles, sum.y);
  }
}
