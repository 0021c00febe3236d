#version 460
#extension GL_GOOGLE_include_directive : require
// Writes the TLAS's instances, in Morton order of their places: a TLAS built in random order traces 40 times slower on
// lavapipe. A group takes a block of the order that the CPU could not rule out; entries of what stays out are null
// references.
#define HELIO_OWN_PUSH
#include "lib/deform.glsl"
#include "shared/assemble.h"

layout(local_size_x = kOrderBlock) in;

layout(buffer_reference, scalar) readonly buffer OrderTable { uint items[]; };
layout(buffer_reference, scalar) readonly buffer VolumeTable { CullVolume items[]; };
layout(buffer_reference, scalar) readonly buffer SphereTable { vec4 items[]; };
layout(buffer_reference, scalar) writeonly buffer TlasTable { TlasInstance items[]; };
layout(buffer_reference, scalar) buffer CounterRef { uint entered; };
layout(push_constant, scalar) uniform Assemble { AssembleConstants assemble; };

const uint kFlagDisableCulling = 1u;  // VK_GEOMETRY_INSTANCE_TRIANGLE_FACING_CULL_DISABLE_BIT_KHR

// Whether the instance's bounding sphere touches a volume.
bool wanted(InstanceRecord instance) {
  if (assemble.volumes == 0ul) return true;
  const vec4 sphere = SphereTable(assemble.spheres).items[instance.mesh];
  const vec4 h = vec4(sphere.xyz, 1.0);
  const vec3 centre = vec3(dot(instance.rows[0], h), dot(instance.rows[1], h), dot(instance.rows[2], h));
  // The largest stretch of the transform is no more than this [Gershgorin]; exact where its axes are perpendicular.
  const mat3 rows = mat3(instance.rows[0].xyz, instance.rows[1].xyz, instance.rows[2].xyz);
  const mat3 gram = rows * transpose(rows);
  const float stretch = sqrt(max(max(dot(abs(gram[0]), vec3(1.0)), dot(abs(gram[1]), vec3(1.0))), dot(abs(gram[2]), vec3(1.0))));
  const float radius = sphere.w * stretch;
  for (uint v = 0u; v < assemble.volume_count; ++v) {
    const CullVolume volume = VolumeTable(assemble.volumes).items[v];
    const vec3 relative = centre - volume.position;
    if (length(relative) < volume.radius + radius) return true;
    bool inside = true;
    for (int i = 0; i < 4; ++i) inside = inside && dot(volume.sides[i], relative) > -radius;
    if (inside) return true;
  }
  return false;
}

void main() {
  const uint output_entry = gl_GlobalInvocationID.x;
  if (output_entry >= assemble.capacity) return;
  TlasInstance result;
  result.rows = vec4[3](vec4(1, 0, 0, 0), vec4(0, 1, 0, 0), vec4(0, 0, 1, 0));
  result.custom_index_and_mask = 0u;
  result.hit_group_and_flags = 0u;
  result.blas = 0ul;
  if (gl_WorkGroupID.x < assemble.block_count) {
    const uint block = assemble.blocks == 0ul ? gl_WorkGroupID.x : OrderTable(assemble.blocks).items[gl_WorkGroupID.x];
    const uint entry = block * kOrderBlock + gl_LocalInvocationID.x;
    if (entry < assemble.count) {
      const uint slot = OrderTable(assemble.order).items[entry];
      const InstanceRecord instance = InstanceTable(assemble.instances).items[slot];
      // What was scaled to nothing has no rows: rays cannot meet it.
      const bool there = instance.mesh != kNoMesh && (instance.rows[0].xyz != vec3(0.0) || instance.rows[1].xyz != vec3(0.0) || instance.rows[2].xyz != vec3(0.0));
      if (there) {
        MeshRecord mesh = MeshTable(assemble.meshes).items[instance.mesh];
        if (instance.deform == 0ul && instance.level > 0u) mesh = MeshTable(assemble.meshes).items[mesh.coarser + instance.level - 1u];
        const uint64_t blas = instance.deform != 0ul ? DeformRef(instance.deform).record.blas : mesh.blas;
        // What has a BLAS of its own was decided on the CPU.
        if (blas != 0ul && (instance.deform != 0ul || wanted(instance))) {
          result.rows = instance.rows;
          result.custom_index_and_mask = slot | kMaskSolid << 24;
          result.hit_group_and_flags = kFlagDisableCulling << 24;
          result.blas = blas;
          atomicAdd(CounterRef(assemble.entered).entered, 1u);
        }
      }
    }
  }
  TlasTable(assemble.output_).items[output_entry] = result;
}
