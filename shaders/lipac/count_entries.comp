#version 460
#extension GL_GOOGLE_include_directive : require
// Where not everybody finds room in the TLAS: how many instances of each group surely do, and how many if there is some left.
#include "lib/lipac.glsl"

layout(local_size_x = kLipacGroup) in;

shared uint sure[kBitWords], perhaps[kBitWords];
HELIO_GROUP_RANK(sure)
HELIO_GROUP_RANK(perhaps)

void main() {
  uint from, room;
  findRoom(from, room);
  if (from == kAllFit) return;
  const uint index = gl_GlobalInvocationID.x;
  const uint entry = index < lipac.count ? WordTable(lipac.entries).items[index] : 0u;
  const bool wanted = kindOf(entry) != kKindNone;
  uvec2 total;
  groupRank_sure(wanted && rankOf(entry) >= from, total.x);
  groupRank_perhaps(wanted && rankOf(entry) + 1u == from, total.y);
  if (gl_LocalInvocationIndex == 0u) PairTable(lipac.entry_sums).items[gl_WorkGroupID.x] = total;
}
