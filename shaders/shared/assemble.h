#ifndef HELIO_SHARED_ASSEMBLE_H
#define HELIO_SHARED_ASSEMBLE_H
#include "shared/types.h"

HELIO_SHARED_BEGIN

// VkAccelerationStructureInstanceKHR, as Vulkan lays it out.
struct TlasInstance {
  vec4 rows[3];
  uint custom_index_and_mask;  // 24 | 8 bits
  uint hit_group_and_flags;    // 24 | 8 bits
  uint64_t blas;               // 0: null, never hit
};

struct AssembleConstants {
  uint64_t order;  // uint: slots in Morton order
  uint64_t instances;
  uint64_t meshes;
  uint64_t output_;  // TlasInstance
  uint count;        // entries of `order`
  uint capacity;     // entries of `output_`: what lies behind `count` becomes null
};

HELIO_SHARED_END
#endif
