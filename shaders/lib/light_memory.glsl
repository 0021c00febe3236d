// What shadow rays tell the light grid (shared/light_lists.h). Counters are integers, and of several lamps that a cell could
// take on the brightest wins: so the order of invocations decides nothing.
#ifndef HELIO_LIGHT_MEMORY_GLSL
#define HELIO_LIGHT_MEMORY_GLSL
#include "lib/light_candidates.glsl"
#include "lib/lights.glsl"

layout(buffer_reference, scalar, buffer_reference_align = 4) buffer LightMemoryTable { LightMemory items[]; };

// A shadow ray from `p` went to the lamp `slot`, whose weight is `weight`, `distance` metres away.
void noteLamp(uvec2 pixel, uint turn, vec3 p, uint slot, float weight, float distance, bool seen) {
  if ((pixel.y * frame.width + pixel.x + turn) % frame.light_note_stride != 0u) return;
  const uint index = lightCellOf(p);
  if (index == kNothing) return;
  LightMemoryTable memories = LightMemoryTable(frame.light_memory);
  LightCellTable cells = LightCellTable(frame.light_cells);
  const uint count = cells.items[index].count;
  for (uint i = 0u; i < count; ++i) {
    if (cells.items[index].slots[i] != slot) continue;
    atomicAdd(memories.items[index].tried[i], 1u);
    if (seen) atomicAdd(memories.items[index].seen[i], 1u);
    return;
  }
  if (seen) atomicMax(memories.items[index].candidate, packCandidate(slot, weight / max(distance * distance, 1e-6)));
}

#endif
