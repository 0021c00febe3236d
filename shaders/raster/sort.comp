#version 460
#extension GL_GOOGLE_include_directive : require
// Rasterising, fourth: brings the parts into the order of tiles.
#include "raster/raster.glsl"

layout(local_size_x = kSortGroup) in;

void main() {
  const uint count = min(rasterCounts().counts.parts, raster.part_capacity), step = gl_NumWorkGroups.x * kSortGroup;
  CounterTable ends = endsOfTiles(), sorted = inOrder();
  PartTable list = parts();
  for (uint i = gl_GlobalInvocationID.x; i < count; i += step) {
    const RasterPart part = list.items[i];
    const uint at = atomicAdd(ends.items[part.tile], 1u);
    sorted.items[at] = part.triangle;
  }
}
