#version 460
#extension GL_GOOGLE_include_directive : require
// Writes the TLAS's instances, in Morton order of their places: a TLAS built in random order traces 40 times slower on
// lavapipe. A group takes a block of the order that the CPU could not rule out; entries of what stays out are null
// references.
#define HELIO_OWN_PUSH
#include "lib/bounds.glsl"
#include "lib/traced_instance.glsl"
#include "shared/assemble.h"

layout(local_size_x = kOrderBlock) in;

layout(buffer_reference, scalar) readonly buffer OrderTable { uint items[]; };
layout(buffer_reference, scalar) readonly buffer VolumeTable { CullVolume items[]; };
layout(buffer_reference, scalar) readonly buffer SphereTable { vec4 items[]; };
layout(buffer_reference, scalar) writeonly buffer TlasTable { TlasInstance items[]; };
layout(buffer_reference, scalar) buffer CounterRef { uint entered; };
layout(buffer_reference, scalar) writeonly buffer UntracedTable { uint items[]; };
const float kSmallest = 1e-6;  // metres

layout(push_constant, scalar) uniform Assemble { AssembleConstants assemble; };

// How large the instance's bounding sphere is as seen from a volume that it touches; 0: it touches none.
float wanted(InstanceRecord instance) {
  if (assemble.volumes == 0ul) return 1.0;
  const vec4 sphere = SphereTable(assemble.spheres).items[instance.mesh];
  const vec3 centre = placed(instance, sphere.xyz);
  const float radius = sphere.w * largestStretch(instance);
  float largest = 0.0;
  for (uint v = 0u; v < assemble.volume_count; ++v) {
    const CullVolume volume = VolumeTable(assemble.volumes).items[v];
    const vec3 relative = centre - volume.position;
    const float distance = length(relative);
    bool inside = true;
    for (int i = 0; i < 4; ++i) inside = inside && dot(volume.sides[i], relative) > -radius;
    if (inside || distance < volume.radius + radius) largest = max(largest, max(radius, kSmallest) / max(distance, radius + kSmallest));
  }
  return largest;
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
      if (isThere(instance)) {
        // What has a BLAS of its own was decided on the CPU.
        const bool shares = sharesBlas(instance);
        const float importance = shares ? wanted(instance) : 1.0;
        const uint64_t blas = blasOf(MeshTable(assemble.meshes), instance);
        if (shares && importance > 0.0) need(assemble.needs, recordOf(MeshTable(assemble.meshes), instance), floatBitsToUint(importance));
        if (importance > 0.0 && blas != 0ul) {
          result.rows = instance.rows;
          result.custom_index_and_mask = slot | kMaskSolid << 24;
          result.hit_group_and_flags = kFlagDisableCulling << 24;
          result.blas = blas;
          atomicAdd(CounterRef(assemble.entered).entered, 1u);
          UntracedTable(assemble.untraced).items[slot] = 0u;
        }
      }
    }
  }
  TlasTable(assemble.output_).items[output_entry] = result;
}
