#version 460
#extension GL_GOOGLE_include_directive : require
// How many instances of each group surely find room in the TLAS, and how many do if there is some left.
#include "lib/lipac.glsl"

layout(local_size_x = kLipacGroup) in;

shared uint sure[kBitWords], perhaps[kBitWords];
HELIO_GROUP_RANK(sure)
HELIO_GROUP_RANK(perhaps)

void main() {
  const uint index = gl_GlobalInvocationID.x;
  const uint entry = index < lipac.count ? WordTable(lipac.entries).items[index] : 0u;
  const bool wanted = kindOf(entry) != kKindNone;
  uint last, room;
  findRoom(last, room);
  uvec2 total;
  groupRank_sure(wanted && rankOf(entry) > last, total.x);
  groupRank_perhaps(wanted && rankOf(entry) == last, total.y);
  if (gl_LocalInvocationIndex == 0u) PairTable(lipac.entry_sums).items[gl_WorkGroupID.x] = total;
}
