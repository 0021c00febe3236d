#version 460
#extension GL_GOOGLE_include_directive : require
// Who touches the volume, and at which level of detail.
#include "cull/cull.glsl"
#include "lib/bounds.glsl"

layout(local_size_x = kCullGroup) in;

shared uint counts[kMostLevels];

uint levelOf(DrawVolume volume, CullMesh mesh, vec3 centre, float radius, float stretch) {
  const float allowed = volume.error + volume.error_per_metre * max(0.0, distance(centre, volume.eye) - radius);
  uint level = 0u;
  for (uint l = 1u; l < mesh.level_count; ++l)
    if (mesh.errors[l] * stretch <= allowed) level = l;
  return level;
}

uint keyOf(uint slot, DrawVolume volume) {
  const InstanceRecord instance = InstanceTable(cull.instances).items[slot];
  const uint key = instance.mesh << kKeyLevelBits;
  if (instance.mesh == kNoMesh) return kNotDrawn;
  if (cull.filter_ != 0ul && Words(cull.filter_).items[slot] == 0u) return key | kNotDrawn;
  const CullMesh mesh = CullMeshTable(cull.meshes).items[instance.mesh];
  const float stretch = largestStretch(instance);
  const vec3 centre = placed(instance, mesh.centre);
  const float radius = mesh.radius * stretch;
  for (uint i = 0u; i < volume.plane_count; ++i)
    if (dot(volume.planes[i].xyz, centre) + volume.planes[i].w < -radius) return key | kNotDrawn;
  if (volume.has_inner != 0u) {
    bool within = true;
    for (uint i = 0u; i < 4u; ++i) within = within && dot(volume.planes[i].xyz, centre) + volume.inner[i] >= radius;
    if (within) return key | kNotDrawn;
  }
  if (2.0 * radius <= volume.least) return key | kNotDrawn;
  return key | levelOf(volume, mesh, centre, radius, stretch);
}

void main() {
  const uint entry = gl_GlobalInvocationID.x;
  if (gl_LocalInvocationIndex < kMostLevels) counts[gl_LocalInvocationIndex] = 0u;
  barrier();
  if (entry < cull.count) {
    const uint key = keyOf(Words(cull.by_mesh).items[entry], VolumeTable(cull.volumes).items[gl_WorkGroupID.y]);
    keys(gl_WorkGroupID.y).items[entry] = key;
    const uint level = bitfieldExtract(key, 0, int(kKeyLevelBits));
    if (level != kNotDrawn) atomicAdd(counts[level], 1u);
  }
  barrier();
  if (gl_LocalInvocationIndex < kMostLevels)
    sums(gl_WorkGroupID.y).items[gl_WorkGroupID.x].n[gl_LocalInvocationIndex] = counts[gl_LocalInvocationIndex];
}
