// Rasterising in compute shaders: GPUs for data centres have a few units that draw and a hundred that compute.
#ifndef HELIO_SHARED_RASTER_H
#define HELIO_SHARED_RASTER_H
#include "shared/shadow_map.h"
#include "shared/types.h"

HELIO_SHARED_BEGIN

HELIO_CONSTANT kTriangleGroup = 128u;  // threads, each with a triangle
HELIO_CONSTANT kSpreadGroup = 64u;     // threads that find the tiles of a large triangle
HELIO_CONSTANT kSpreadGroups = 8192u;  // groups, which take turns
HELIO_CONSTANT kFewTiles = 4u;         // that a thread finds by itself
HELIO_CONSTANT kSortGroup = 256u;      // threads, each with a large triangle's part of a tile
HELIO_CONSTANT kSortGroups = 512u;     // which take turns
HELIO_CONSTANT kTileBits = 6u;         // 64 x 64 pixels
HELIO_CONSTANT kTileGroup = 256u;      // threads that draw into a tile
HELIO_CONSTANT kBlockSide = 4u;        // pixels along a side of a thread's share of it
HELIO_CONSTANT kTileBatch = 128u;      // triangles of a tile that its threads see at a time
HELIO_CONSTANT kShareParts = 256u;     // parts of a tile that a group draws; others draw its others
// Room for the parts of a pass, all volumes together: one for so many pixels, or texels of a shadow map. 2048 large
// triangles may touch each square of 64 x 64 pixels, 512 of a shadow map; what has no room is drawn by a single thread.
HELIO_CONSTANT kPixelsAPart = 2u;
HELIO_CONSTANT kShadowTexelsAPart = 8u;
HELIO_CONSTANT kSmallTriangle = 64u;  // pixels of its bounds that a thread draws by itself
HELIO_CONSTANT kSubpixelBits = 8u;    // of a corner's place on the screen

// Who was drawn: the place of the triangle among all of the volume's, commands one behind the other, and this bit for
// those that ask a mask.
HELIO_CONSTANT kMaskedTriangle = 0x80000000u;

// A tile that a large triangle may touch.
struct RasterPart {
  uint triangle;
  uint tile;  // of all volumes' one behind the other, row by row
};
// A group's share of a tile: parts in the order of tiles.
struct RasterShare {
  uint tile;
  uint first;
  uint count;
};
// Working memory: RasterCounts; uint a tile: how many of its parts have room; uint a tile: where they end in the order
// of tiles; then RasterShare, as many as there are tiles and full shares; RasterPart; the parts' triangles in the order
// of tiles, and before that the triangles with more than kFewTiles.
struct RasterCounts {
  uint parts;  // those without room too
  uint shares;
  uint spread[kShadowCascades];  // triangles of each volume whose tiles a group finds, those without room too
};
HELIO_CONSTANT kRasterCountsBytes = 24u;
HELIO_CONSTANT kRasterTileBytes = 8u;
HELIO_CONSTANT kRasterShareBytes = 12u;
HELIO_CONSTANT kRasterPartBytes = 12u;  // and its triangle

struct RasterConstants {
  uint64_t frame;       // FrameConstants
  uint64_t slots;       // uint: DrawConstants::slots
  uint64_t commands;    // DrawCommand a draw, then uint a draw: its record, then uint: its first triangle
  uint64_t counts;      // DrawCounts
  uint64_t draws;       // DrawRecord
  uint64_t indices;     // uint: the rasteriser's index buffer
  uint64_t keys;        // uint64_t a pixel: depth and triangle, the nearest is the largest; 0: nothing
  uint64_t parts;       // working memory
  uint64_t shadow_map;  // ShadowMap
  vec2 jitter;
  uint width;
  uint height;
  uint image;  // r32ui: depth's bits, of a shadow map
  uint cascade;
  uint part_capacity;
  uint draw_count;
  uint solid_draws;
};

HELIO_SHARED_END
#endif
