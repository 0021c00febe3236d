#version 460
#extension GL_GOOGLE_include_directive : require
// Rasterising, first: a thread a triangle. It draws what is small; of what is large it lists the tiles that it may touch.
#include "raster/raster.glsl"

layout(local_size_x = kTriangleGroup) in;

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

// False: the list is full.
bool listed(ivec2 tile, uint id, bool crosses) {
  TileCountRef header = TileCountRef(raster.tiles);
  const uint at = atomicAdd(header.count.tiles, 1u);
  if (at >= raster.tile_capacity) return false;
  const uint place = uint(tile.y * tilesAcross().x + tile.x);
  TileTable tiles = TileTable(raster.tiles + kTilesAt);
  tiles.items[at] = RasterTile(id, crosses ? place | kTriangleCrosses : place);
  return true;
}

void main() {
  const uint row = gl_NumWorkGroups.x * kTriangleGroup, triangle = gl_GlobalInvocationID.y * row + gl_GlobalInvocationID.x;
  const DrawCounts counts = CountRef(raster.counts).counts;
  if (triangle >= (kAlphaMasks ? counts.masked_triangles : counts.solid_triangles)) return;
  const uint id = triangle | (kAlphaMasks ? kMaskedTriangle : 0u);
  const Drawn d = drawnTriangle(id);
  const InstanceRecord instance = InstanceTable(frame.instances).items[d.slot];
  const vec4 clip[3] = vec4[](clipCorner(d, instance, 0u), clipCorner(d, instance, 1u), clipCorner(d, instance, 2u));
  if (isOutside(clip)) return;

  ScreenTriangle t;
  if (placeOnScreen(clip, t)) {
    const ivec4 bounds = pixelBounds(t);
    if (any(lessThan(bounds.zw, bounds.xy))) return;
    const ivec2 size = bounds.zw - bounds.xy + 1, reach = max(max(t.corners[0], t.corners[1]), t.corners[2]) - min(min(t.corners[0], t.corners[1]), t.corners[2]);
    // What the screen cuts small may be large: its edge functions must fit.
    if (uint(size.x * size.y) <= kSmallTriangle && max(reach.x, reach.y) < 1 << 14) {
      drawSmall(t, bounds, 0u, 1u, id, d, instance);
      return;
    }
    const ivec4 tiles = bounds >> int(kTileBits);
    for (int y = tiles.y; y <= tiles.w; ++y)
      for (int x = tiles.x; x <= tiles.z; ++x) {
        const ivec4 pixels = tilePixels(ivec2(x, y));
        if (touches(t, pixels) && !listed(ivec2(x, y), id, false))
          drawLarge(t, ivec4(max(pixels.xy, bounds.xy), min(pixels.zw, bounds.zw)), 0u, 1u, id, d, instance);
      }
    return;
  }
  const CrossingTriangle crossing = crossingTriangle(clip);
  const ivec2 tiles = tilesAcross();
  for (int y = 0; y < tiles.y; ++y)
    for (int x = 0; x < tiles.x; ++x) {
      const ivec4 pixels = tilePixels(ivec2(x, y));
      if (touches(crossing, pixels) && !listed(ivec2(x, y), id, true)) drawCrossing(crossing, pixels, 0u, 1u, id, d, instance);
    }
}
