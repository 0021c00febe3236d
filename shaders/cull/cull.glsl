// The tables of culling for the rasteriser. The instances of a volume are gathered by mesh and level in four steps: `mark`
// finds each one's level and counts by group, `scan` adds the groups up, `list` writes slots to where they belong, `commands`
// makes draws of them. Every list keeps the order of its slots: the same scene gives the same commands.
#ifndef HELIO_CULL_GLSL
#define HELIO_CULL_GLSL
#define HELIO_OWN_PUSH
#include "lib/tables.glsl"
#include "shared/draw.h"

struct LevelCounts {
  uint n[kMostLevels];
};

layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Words { uint items[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer SumTable { LevelCounts items[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer RangeTable { DrawRange items[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer CullMeshTable { CullMesh items[]; };
layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer DrawTable { DrawRecord items[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer VolumeTable { DrawVolume items[]; };
layout(push_constant, scalar) uniform Cull { CullConstants cull; };

uint groups() { return (cull.count + kCullGroup - 1u) / kCullGroup; }

// Tables of this volume.
Words keys(uint volume) { return Words(cull.keys + 4ul * cull.count * volume); }
Words slots(uint volume) { return Words(cull.slots + 4ul * cull.count * volume); }
SumTable sums(uint volume) { return SumTable(cull.sums + 4ul * kMostLevels * (groups() + 1u) * volume); }
RangeTable ranges(uint volume) { return RangeTable(cull.ranges + 8ul * kMostLevels * cull.mesh_count * volume); }

#endif
