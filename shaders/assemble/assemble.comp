#version 460
#extension GL_GOOGLE_include_directive : require
// Writes the TLAS's instances, in Morton order of their places: a TLAS built in random order traces 40 times slower on
// lavapipe. Inactive entries are null references.
#define HELIO_OWN_PUSH
#include "lib/tables.glsl"
#include "shared/assemble.h"

layout(local_size_x = 64) in;

layout(buffer_reference, scalar) readonly buffer OrderTable { uint items[]; };
layout(buffer_reference, scalar) writeonly buffer TlasTable { TlasInstance items[]; };
layout(push_constant, scalar) uniform Assemble { AssembleConstants assemble; };

const uint kFlagDisableCulling = 1u;  // VK_GEOMETRY_INSTANCE_TRIANGLE_FACING_CULL_DISABLE_BIT_KHR

void main() {
  const uint entry = gl_GlobalInvocationID.x;
  if (entry >= assemble.capacity) return;
  TlasInstance result;
  result.rows = vec4[3](vec4(1, 0, 0, 0), vec4(0, 1, 0, 0), vec4(0, 0, 1, 0));
  result.custom_index_and_mask = 0u;
  result.hit_group_and_flags = 0u;
  result.blas = 0ul;
  if (entry < assemble.count) {
    const uint slot = OrderTable(assemble.order).items[entry];
    const InstanceRecord instance = InstanceTable(assemble.instances).items[slot];
    if (instance.mesh != kNoMesh) {
      result.rows = instance.rows;
      result.custom_index_and_mask = slot | kMaskSolid << 24;
      result.hit_group_and_flags = kFlagDisableCulling << 24;
      result.blas = MeshTable(assemble.meshes).items[instance.mesh].blas;
    }
  }
  TlasTable(assemble.output_).items[entry] = result;
}
