// Which of the BLASes that instances share one asks for (accel::SharedBlases).
#ifndef HELIO_SHARED_BLAS_GLSL
#define HELIO_SHARED_BLAS_GLSL
#include "lib/tables.glsl"

layout(buffer_reference, scalar) buffer NeedTable { uint items[]; };

// The record of its mesh at its level of detail.
uint recordOf(MeshTable meshes, InstanceRecord instance) {
  return instance.level == 0u ? instance.mesh : meshes.items[instance.mesh].coarser + instance.level - 1u;
}

// `importance` > 0: who is to be served first.
void need(uint64_t needs, uint record, uint importance) {
  if (needs == 0ul) return;
  NeedTable table = NeedTable(needs);
  if (table.items[record] < importance) atomicMax(table.items[record], importance);
}

#endif
