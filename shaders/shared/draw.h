// Rasterising: what there is to draw, who of it is seen, and the commands that the GPU writes for itself.
#ifndef HELIO_SHARED_DRAW_H
#define HELIO_SHARED_DRAW_H
#include "shared/scene.h"

HELIO_SHARED_BEGIN

// One submesh of a mesh at one level of detail.
struct DrawRecord {
  uint64_t positions;
  uint first_index;  // in the rasteriser's index buffer
  uint index_count;
  uint mesh;
  uint level;
  uint geometry;  // within the mesh
};

// What culling must know of a mesh: the sphere around its bounds, and how far off its levels are, metres.
struct CullMesh {
  vec3 centre;
  float radius;
  float errors[kMostLevels];
  uint level_count;
};

// A convex volume; who touches it is drawn. `planes`: inward unit normals n and distances d, n.x + d > 0 inside.
HELIO_CONSTANT kMostPlanes = 6u;
struct DrawVolume {
  vec4 planes[kMostPlanes];
  uint plane_count;
  // Of the first four planes, for what is drawn elsewhere: who lies within all of them by its whole bounds is left out.
  vec4 inner;
  uint has_inner;
  // A level of detail may be off by `error` + `error_per_metre` times the distance to `eye`; both negative: none.
  vec3 eye;
  float error;
  float error_per_metre;
  float least;  // metres: who is no larger is left out
};

// VkDrawIndexedIndirectCommand.
struct DrawCommand {
  uint index_count;
  uint instance_count;
  uint first_index;
  int vertex_offset;
  uint first_instance;
};
// Bytes of it, and of a table of them that has for each its record and its first triangle among those of its kind.
HELIO_CONSTANT kCommandBytes = 20u;
HELIO_CONSTANT kCommandTableBytes = 28u;

// What the lists of one volume came to. Draws that ask a mask come behind those that do not.
struct DrawCounts {
  uint solid;   // commands from the first on
  uint masked;  // commands from DrawTable::solid on
  uint triangles;
  uint solid_triangles;
  uint masked_triangles;
  // VkDispatchIndirectCommand: groups of kTriangleGroup triangles (shared/raster.h).
  uint solid_groups[3];
  uint masked_groups[3];
};
HELIO_CONSTANT kMostGroupsPerRow = 32768u;

// Instances of one mesh at each of its levels: entries of the volume's list of that level.
struct DrawRange {
  uint first[kMostLevels];
  uint end[kMostLevels];
};

HELIO_CONSTANT kCullGroup = 64u;   // entries of by_mesh, and threads
HELIO_CONSTANT kScanGroup = 256u;  // threads that add up the groups, and that write the commands
HELIO_CONSTANT kNotDrawn = 7u;     // in the place of a level
HELIO_CONSTANT kKeyLevelBits = 3u;

// Pushed to the passes of shaders/cull; a row of groups a volume. Tables of a volume lie one behind the other.
struct CullConstants {
  uint64_t by_mesh;     // uint: slots, ascending by mesh, then by slot
  uint64_t mesh_first;  // uint a mesh: its first entry of `by_mesh`; and one more
  uint64_t instances;   // InstanceRecord
  uint64_t meshes;      // CullMesh
  uint64_t draws;       // DrawRecord: those that ask no mask, then those that do
  uint64_t volumes;     // DrawVolume
  uint64_t filter_;     // uint a slot: 0 is not drawn; address 0: all may be
  uint64_t keys;        // uint an entry: level | mesh << kKeyLevelBits
  uint64_t sums;        // uint[kMostLevels] a group, and the sum of all
  uint64_t slots;       // uint an entry: the lists of the levels, one behind the other
  uint64_t ranges;      // DrawRange a mesh
  uint64_t commands;    // DrawCommand a draw; uint a draw: its record; uint a draw: its first triangle; then DrawCounts
  uint count;           // entries of by_mesh
  uint mesh_count;
  uint draw_count;
  uint solid_draws;
};

// Pushed before the draws of a volume: instances are `slots[gl_InstanceIndex]`, their draw is `records[gl_DrawID]`.
struct DrawConstants {
  uint64_t frame;  // FrameConstants
  uint64_t slots;
  uint64_t records;  // uint
  uint64_t draws;    // DrawRecord
  vec2 jitter;
  uint64_t shadow_map;  // ShadowMap (shared/shadow_map.h), when one of its cascades is drawn
  uint cascade;
};

HELIO_SHARED_END
#endif
