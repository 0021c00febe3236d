#version 460
#extension GL_GOOGLE_include_directive : require
// Latency mitigation [Kelling et al. 2024, 3.6]: the hitboxes of what has just come into a viewer's sight become active.
#include "lib/lipac_instance.glsl"

layout(local_size_x = kLipacGroup) in;

layout(buffer_reference, scalar) readonly buffer SightTable { LipacSight items[]; };
layout(buffer_reference, scalar) readonly buffer VolumeTable { CullVolume items[]; };

// A frustum with a margin.
bool touches(uint index, Placed placed) {
  const CullVolume volume = VolumeTable(lipac.volumes).items[index];
  const vec3 relative = placed.centre - volume.position;
  const float radius = volume.radius + length(placed.half_extent);
  for (int i = 0; i < 4; ++i)
    if (dot(volume.sides[i], relative) <= -radius) return false;
  return true;
}

void main() {
  const uint index = gl_GlobalInvocationID.x;
  if (index >= lipac.sight_count * kOrderBlock) return;
  const LipacSight sight = SightTable(lipac.sights).items[index / kOrderBlock];
  const uint entry = (sight.block & ~kSightWhole) * kOrderBlock + index % kOrderBlock;
  if (entry >= lipac.count) return;
  const InstanceRecord instance = InstanceTable(lipac.instances).items[slotAt(entry)];
  if (!isThere(instance)) return;
  const Placed placed = placedOf(instance);
  const bool seen_before = (sight.block & kSightWhole) == 0u && touches(2u * sight.viewer + 1u, placed);
  if (!seen_before && touches(2u * sight.viewer, placed)) openHitbox(placed.cell);
}
