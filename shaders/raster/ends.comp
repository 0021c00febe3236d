#version 460
#extension GL_GOOGLE_include_directive : require
// Rasterising, third: where the parts of each tile begin in the order of tiles, and who draws them. One group of threads; a thread
// takes neighbours.
#include "raster/raster.glsl"

layout(local_size_x = kSortGroup) in;

shared uvec2 totals[kSortGroup];  // parts, shares

uint sharesOf(uint parts) { return (parts + kShareParts - 1u) / kShareParts; }

void main() {
  const uint thread = gl_LocalInvocationIndex, tiles = allTiles(), each = (tiles + kSortGroup - 1u) / kSortGroup;
  const uint begin = min(thread * each, tiles), end = min(begin + each, tiles);
  CounterTable counts = partsOfTiles(), ends = endsOfTiles();
  uvec2 total = uvec2(0u);
  for (uint t = begin; t < end; ++t) total += uvec2(counts.items[t], sharesOf(counts.items[t]));
  totals[thread] = total;
  barrier();
  uvec2 at = uvec2(0u);
  for (uint t = 0u; t < thread; ++t) at += totals[t];
  ShareTable list = shares();
  for (uint t = begin; t < end; ++t) {
    const uint count = counts.items[t];
    ends.items[t] = at.x;  // sorting moves it to the end
    for (uint first = 0u; first < count; first += kShareParts)
      list.items[at.y++] = RasterShare(t, at.x + first, min(kShareParts, count - first));
    at.x += count;
  }
  RasterCountsRef header = rasterCounts();
  if (thread == kSortGroup - 1u) header.counts.shares = at.y;
}
