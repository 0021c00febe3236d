#version 460
#extension GL_GOOGLE_include_directive : require
// Writes the slots of each level behind those of the finer ones, in the order of `by_mesh`, and where each mesh's lie.
#include "cull/cull.glsl"

layout(local_size_x = kCullGroup) in;

shared uint levels[kCullGroup];

void main() {
  const uint entry = gl_GlobalInvocationID.x, volume = gl_WorkGroupID.y;
  const uint key = entry < cull.count ? keys(volume).items[entry] : kNotDrawn;
  const uint level = bitfieldExtract(key, 0, int(kKeyLevelBits));
  levels[gl_LocalInvocationIndex] = level;
  barrier();
  if (entry >= cull.count) return;

  // Of each level: entries before this one.
  uint before[kMostLevels];
  uint base = 0u;
  for (uint l = 0u; l < kMostLevels; ++l) {
    before[l] = base + sums(volume).items[gl_WorkGroupID.x].n[l];
    base += sums(volume).items[groups()].n[l];
  }
  for (uint i = 0u; i < gl_LocalInvocationIndex; ++i)
    if (levels[i] != kNotDrawn) ++before[levels[i]];
  const uint slot = Words(cull.by_mesh).items[entry];
  if (level != kNotDrawn) slots(volume).items[before[level]] = slot;

  const uint mesh = key >> kKeyLevelBits;
  if (entry == Words(cull.mesh_first).items[mesh])
    for (uint l = 0u; l < kMostLevels; ++l) ranges(volume).items[mesh].first[l] = before[l];
  if (entry + 1u == Words(cull.mesh_first).items[mesh + 1u])
    for (uint l = 0u; l < kMostLevels; ++l) ranges(volume).items[mesh].end[l] = before[l] + (l == level ? 1u : 0u);
}
