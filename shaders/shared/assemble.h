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

// Instances of one block are neighbours in the order: a group of threads takes one, and what is culled by blocks costs
// nothing further.
HELIO_CONSTANT kOrderBlock = 64u;

// A frustum through a point, and a sphere around it.
struct CullVolume {
  vec3 position;
  float radius;   // metres
  vec3 sides[4];  // inward unit normals
};

struct AssembleConstants {
  uint64_t order;  // uint: slots in Morton order
  uint64_t instances;
  uint64_t meshes;    // MeshRecord, of what rays meet
  uint64_t needs;     // uint, as the mesh table: how much its BLAS is needed; 0: nobody asks
  uint64_t output_;   // TlasInstance
  uint64_t blocks;    // uint: blocks of `order` that are looked at; 0: all
  uint64_t volumes;   // CullVolume: who touches none stays out; 0: all enter
  uint64_t spheres;   // vec4 a mesh: centre and radius of its bounds
  uint64_t entered;   // uint: counts who entered
  uint64_t untraced;  // uint, by slot: becomes 0 where rays meet the instance
  uint count;         // entries of `order`
  uint block_count;
  uint volume_count;
  uint capacity;  // entries of `output_`: what lies behind the blocks becomes null
};

HELIO_SHARED_END
#endif
