#version 460
#extension GL_GOOGLE_include_directive : require
// The draws of what is there to draw, without gaps and in the order of their records; one group of threads a volume and kind
// (without a mask, with one). A thread takes neighbours.
#include "cull/cull.glsl"

layout(local_size_x = kScanGroup) in;

layout(buffer_reference, scalar, buffer_reference_align = 4) buffer CommandTable { DrawCommand items[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer CountTable { DrawCounts items[]; };

shared uint totals[kScanGroup];
shared uint triangles;

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
  if (thread == 0u) triangles = 0u;
  uint count = 0u, ignored;
  for (uint d = from; d < to; ++d) count += instancesOf(DrawTable(cull.draws).items[d], ignored) > 0u ? 1u : 0u;
  totals[thread] = count;
  barrier();
  uint at = begin, sum = 0u;
  for (uint t = 0u; t < kScanGroup; ++t) {
    if (t < thread) at += totals[t];
    sum += totals[t];
  }
  const uint64_t all_bytes = uint64_t(kCommandBytes + kCommandRecordBytes) * cull.draw_count;
  const uint64_t table = cull.commands + all_bytes * volume;
  CommandTable commands = CommandTable(table);
  Words records = Words(table + uint64_t(kCommandBytes) * cull.draw_count);
  uint drawn = 0u;
  for (uint d = from; d < to; ++d) {
    const DrawRecord draw = DrawTable(cull.draws).items[d];
    uint first;
    const uint instances = instancesOf(draw, first);
    if (instances == 0u) continue;
    commands.items[at] = DrawCommand(draw.index_count, instances, draw.first_index, 0, first);
    records.items[at] = d;
    drawn += instances * (draw.index_count / 3u);
    ++at;
  }
  atomicAdd(triangles, drawn);
  barrier();
  if (thread == 0u) {
    CountTable counts = CountTable(cull.commands + all_bytes * gl_NumWorkGroups.y);
    if (masked) counts.items[volume].masked = sum;
    else counts.items[volume].solid = sum;
    atomicAdd(counts.items[volume].triangles, triangles);
  }
}
