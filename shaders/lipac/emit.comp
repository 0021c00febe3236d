#version 460
#extension GL_GOOGLE_include_directive : require
// Writes the TLAS instances of what is active, omitted and requested, in the order's order: a TLAS built in random order
// traces 40 times slower on lavapipe. Of the two TLASes one has no boxes: null references are in their places.
#include "lib/lipac_instance.glsl"

layout(local_size_x = kLipacGroup) in;

layout(buffer_reference, scalar) writeonly buffer TlasTable { TlasInstance items[]; };

shared uint sure[kBitWords], perhaps[kBitWords];
HELIO_GROUP_RANK(sure)
HELIO_GROUP_RANK(perhaps)

// The unit cube, as the mesh's bounds, as the instance stands.
void rowsOfBounds(InstanceRecord instance, out vec4 rows[3]) {
  const MeshBounds bounds = BoundsTable(lipac.bounds).items[instance.mesh];
  const vec3 half_extent = max(bounds.half_extent, vec3(kThinnest));
  for (int i = 0; i < 3; ++i)
    rows[i] = vec4(instance.rows[i].xyz * 2.0 * half_extent, dot(instance.rows[i], vec4(bounds.centre - half_extent, 1.0)));
}

void main() {
  const uint index = gl_GlobalInvocationID.x;
  const uint entry = index < lipac.count ? WordTable(lipac.entries).items[index] : 0u;
  const uint kind = kindOf(entry);
  uint from, room, total;
  findRoom(from, room);
  const bool wants = kind != kKindNone, fits = wants && rankOf(entry) >= from, may_fit = wants && rankOf(entry) + 1u == from;
  uvec2 place = PairTable(lipac.entry_sums).items[gl_WorkGroupID.x];
  place.x += groupRank_sure(fits, total);
  if (from != kAllFit) place.y += groupRank_perhaps(may_fit, total);
  if ((entry & kThereBit) == 0u) return;
  const uint slot = slotAt(index);
  const bool enters = fits || (may_fit && place.y < room);
  // The shadow map has what rays do not meet.
  WordTable(lipac.untraced).items[slot] = enters && kind == kKindInstance ? 0u : 1u;
  if (!wants) return;
  if (!enters) {
    WordTable(lipac.hits).items[slot] = kHitDropped;  // the feedback makes it inactive
    return;
  }

  const InstanceRecord instance = InstanceTable(lipac.instances).items[slot];
  TlasInstance result;
  if (kind == kKindInstance) {
    result.rows = instance.rows;
    result.custom_index_and_mask = slot | kMaskSolid << 24;
    result.hit_group_and_flags = kFlagDisableCulling << 24;
    result.blas = blasOf(instance);
  } else {
    rowsOfBounds(instance, result.rows);
    result.custom_index_and_mask = slot | kMaskOmitted << 24;
    result.hit_group_and_flags = kHitGroupOmitted | lipac.box_flags << 24;
    result.blas = lipac.cube;
  }
  const uint at = place.x + min(place.y, room);
  TlasTable(lipac.counted).items[at] = result;
  if (lipac.output_ == 0ul) return;
  if (kind == kKindInstance) TlasTable(lipac.output_).items[at] = result;
  else TlasTable(lipac.output_).items[at].blas = 0ul;
}
