// Rasterising in compute shaders: GPUs for data centres have a few units that draw and a hundred that compute.
#ifndef HELIO_SHARED_RASTER_H
#define HELIO_SHARED_RASTER_H
#include "shared/types.h"

HELIO_SHARED_BEGIN

HELIO_CONSTANT kTriangleGroup = 128u;  // threads, each with a triangle
HELIO_CONSTANT kTileGroup = 64u;       // threads that share a tile of a large triangle
HELIO_CONSTANT kTileGroups = 8192u;    // groups, which take turns
HELIO_CONSTANT kTileBits = 6u;         // 64 x 64 pixels
// Room for the tiles of a pass, all volumes together: a tile for so many pixels, or texels of a shadow map. 2048 large
// triangles may touch each square of 64 x 64 pixels; what has no room is drawn by a single thread.
HELIO_CONSTANT kPixelsATile = 2u;
HELIO_CONSTANT kShadowTexelsATile = 16u;
HELIO_CONSTANT kSmallTriangle = 64u;  // pixels of its bounds that a thread draws by itself
HELIO_CONSTANT kSubpixelBits = 8u;    // of a corner's place on the screen

// Who was drawn: the place of the triangle among all of the volume's, commands one behind the other, and this bit for
// those that ask a mask.
HELIO_CONSTANT kMaskedTriangle = 0x80000000u;
// In a tile's place: the triangle reaches behind the eye.
HELIO_CONSTANT kTriangleCrosses = 0x80000000u;

// A tile of a picture that a large triangle may touch.
struct RasterTile {
  uint triangle;
  uint tile;  // row by row; and kTriangleCrosses
};
// Before the tiles.
struct RasterTileCount {
  uint tiles;  // that there were; those beyond the capacity were drawn at once
};

struct RasterConstants {
  uint64_t frame;       // FrameConstants
  uint64_t slots;       // uint: DrawConstants::slots
  uint64_t commands;    // DrawCommand a draw, then uint a draw: its record, then uint: its first triangle
  uint64_t counts;      // DrawCounts
  uint64_t draws;       // DrawRecord
  uint64_t indices;     // uint: the rasteriser's index buffer
  uint64_t keys;        // uint64_t a pixel: depth and triangle, the nearest is the largest; 0: nothing
  uint64_t tiles;       // RasterTileCount, then RasterTile
  uint64_t shadow_map;  // ShadowMap
  vec2 jitter;
  uint width;
  uint height;
  uint image;  // r32ui: depth's bits, of a shadow map
  uint cascade;
  uint tile_capacity;
  uint draw_count;
  uint solid_draws;
};

HELIO_SHARED_END
#endif
