// Large triangles, and the tiles that they may touch.
#ifndef HELIO_RASTER_PARTS_GLSL
#define HELIO_RASTER_PARTS_GLSL
#extension GL_KHR_shader_subgroup_ballot : require
#include "raster/raster.glsl"

// Where a triangle lies on the screen.
struct Shape {
  bool crosses;  // it reaches behind the eye
  ScreenTriangle t;
  CrossingTriangle crossing;
  ivec4 bounds;  // pixels; empty: the last before the first
};

Shape shapeOf(vec4 clip[3]) {
  Shape shape;
  shape.crosses = !placeOnScreen(clip, shape.t);
  if (shape.crosses) shape.crossing = crossingTriangle(clip);
  shape.bounds = shape.crosses ? ivec4(0, 0, ivec2(raster.width, raster.height) - 1) : pixelBounds(shape.t);
  return shape;
}

// Whether a pixel of the tile may be in the triangle: not all of its corners lie outside of one edge.
bool touches(ScreenTriangle t, ivec4 pixels) {
  const i64vec2 c[3] = i64vec2[](i64vec2(t.corners[0]), i64vec2(t.corners[1]), i64vec2(t.corners[2]));
  const bool turned = edge(c[0], c[1], c[2]) < 0l;
  for (int k = 0; k < 3; ++k) {
    bool within = false;
    for (int i = 0; i < 4; ++i) {
      const ivec2 corner = ivec2((i & 1) == 0 ? pixels.x : pixels.z, (i & 2) == 0 ? pixels.y : pixels.w);
      const int64_t e = edge(c[k], c[(k + 1) % 3], i64vec2(corner) * (1 << kSubpixelBits));
      within = within || (turned ? e <= 0l : e >= 0l);
    }
    if (!within) return false;
  }
  return true;
}
bool touches(CrossingTriangle t, ivec4 pixels) {
  for (int k = 0; k < 3; ++k) {
    bool within = false;
    for (int i = 0; i < 4; ++i)
      within = within || dot(t.edges[k], vec3((i & 1) == 0 ? pixels.x : pixels.z, (i & 2) == 0 ? pixels.y : pixels.w, 1.0)) >= -t.slack[k];
    if (!within) return false;
  }
  return true;
}

bool touches(Shape shape, ivec4 pixels) { return shape.crosses ? touches(shape.crossing, pixels) : touches(shape.t, pixels); }

uint tileCount(Shape shape) {
  const ivec4 tiles = shape.bounds >> int(kTileBits);
  return uint((tiles.z - tiles.x + 1) * (tiles.w - tiles.y + 1));
}

// False: there is no room.
bool listed(ivec2 tile, uint id) {
  // A place in the list: the subgroup's, then the thread's.
  const uvec4 together = subgroupBallot(true);
  RasterCountsRef header = rasterCounts();
  CounterTable of_tiles = partsOfTiles();
  PartTable list = parts();
  uint first = 0u;
  if (subgroupElect()) first = atomicAdd(header.counts.parts, subgroupBallotBitCount(together));
  const uint at = subgroupBroadcastFirst(first) + subgroupBallotExclusiveBitCount(together);
  if (at >= raster.part_capacity) return false;
  const uint of = raster.cascade * tilesOfAVolume() + uint(tile.y * tilesAcross().x + tile.x);
  atomicAdd(of_tiles.items[of], 1u);
  list.items[at] = RasterPart(id, of);
  return true;
}

// Lists the triangle's parts in the tiles `first`, `first` + `step`, ... of its bounds; draws those that there is no room for.
void listParts(Shape shape, uint first, uint step, uint id, Drawn d, InstanceRecord instance) {
  const ivec4 tiles = shape.bounds >> int(kTileBits);
  const uint count = tileCount(shape);
  const int width = tiles.z - tiles.x + 1;
  for (uint i = first; i < count; i += step) {
    const ivec2 tile = tiles.xy + ivec2(int(i) % width, int(i) / width);
    const ivec4 pixels = tilePixels(tile);
    if (!touches(shape, pixels) || listed(tile, id)) continue;
    const ivec4 within = ivec4(max(pixels.xy, shape.bounds.xy), min(pixels.zw, shape.bounds.zw));
    if (shape.crosses) draw(shape.crossing, within, id, d, instance);
    else draw(shape.t, within, edgesAt(shape.t, i64vec2(within.xy)), id, d, instance);
  }
}

#endif
