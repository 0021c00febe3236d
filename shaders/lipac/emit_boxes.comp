#version 460
#extension GL_GOOGLE_include_directive : require
// Writes the TLAS instances of hitboxes behind those of instances, in Morton order, and null references behind all.
#include "lib/lipac_instance.glsl"

layout(local_size_x = kLipacGroup) in;

layout(buffer_reference, scalar) writeonly buffer TlasTable { TlasInstance items[]; };

shared uint wanted[kBitWords];
HELIO_GROUP_RANK(wanted)

void main() {
  const uint index = gl_GlobalInvocationID.x;
  TlasTable counted = TlasTable(lipac.counted);
  Hitbox hitbox;
  bool box = false;
  if (index < cellCount()) {
    hitbox = HitboxTable(lipac.cells).items[index];
    box = (hitbox.word & 3u) == kStateInactive && hitbox.lowest <= hitbox.highest;
  }
  uint total;
  const uint rank = groupRank_wanted(box, total);
  if (box) {
    const uint place = WordTable(lipac.box_sums).items[gl_WorkGroupID.x] + rank;
    const float reach = uintBitsToFloat(WordTable(lipac.reaches).items[index]);
    const float lowest = unordered(hitbox.lowest), height = max(unordered(hitbox.highest) - lowest, 2.0 * kThinnest);
    const float side = float(kCellMetres) + 2.0 * reach;
    const vec2 corner = cellCorner(index) - reach;
    TlasInstance result;
    result.rows = vec4[3](vec4(side, 0, 0, corner.x), vec4(0, height, 0, lowest), vec4(0, 0, side, corner.y));
    result.custom_index_and_mask = index | kMaskCell << 24;
    result.hit_group_and_flags = kHitGroupCell | lipac.box_flags << 24;
    result.blas = lipac.cube;
    if (place < lipac.counted_capacity) counted.items[place] = result;
  }
  const LipacStatus status = StatusRef(lipac.status).status;
  if (index < lipac.counted_capacity && index >= status.entries) counted.items[index].blas = 0ul;
  if (lipac.output_ != 0ul && index < lipac.capacity && index >= status.entered) TlasTable(lipac.output_).items[index].blas = 0ul;
}
