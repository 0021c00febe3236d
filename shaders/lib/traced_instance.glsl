// What rays meet of an instance.
#ifndef HELIO_TRACED_INSTANCE_GLSL
#define HELIO_TRACED_INSTANCE_GLSL
#include "lib/deform.glsl"
#include "lib/shared_blas.glsl"

const uint kFlagDisableCulling = 1u;  // VK_GEOMETRY_INSTANCE_TRIANGLE_FACING_CULL_DISABLE_BIT_KHR

// What was scaled to nothing has no rows: rays cannot meet it.
bool isThere(InstanceRecord instance) {
  return instance.mesh != kNoMesh && (instance.rows[0].xyz != vec3(0.0) || instance.rows[1].xyz != vec3(0.0) || instance.rows[2].xyz != vec3(0.0));
}

bool sharesBlas(InstanceRecord instance) { return instance.deform == 0ul; }

// 0: none.
uint64_t blasOf(MeshTable meshes, InstanceRecord instance) {
  if (!sharesBlas(instance)) return DeformRef(instance.deform).record.blas;
  return meshes.items[recordOf(meshes, instance)].blas;
}

#endif
