#version 460
#extension GL_GOOGLE_include_directive : require
// Rasterising, second: groups draw the tiles that large triangles touch.
#include "raster/raster.glsl"

layout(local_size_x = kTileGroup) in;

shared vec4 corners[3];

void main() {
  const uint thread = gl_LocalInvocationIndex, count = min(TileCountRef(raster.tiles).count.tiles, raster.tile_capacity);
  for (uint i = gl_WorkGroupID.x; i < count; i += gl_NumWorkGroups.x) {
    const RasterTile job = TileTable(raster.tiles + kTilesAt).items[i];
    const Drawn d = drawnTriangle(job.triangle);
    const InstanceRecord instance = InstanceTable(frame.instances).items[d.slot];
    barrier();  // the last job's corners were read
    if (thread < 3u) corners[thread] = clipCorner(d, instance, thread);
    barrier();
    const vec4 clip[3] = vec4[](corners[0], corners[1], corners[2]);
    const uint tile = job.tile & ~kTriangleCrosses;
    const int across = tilesAcross().x;
    const ivec4 pixels = tilePixels(ivec2(int(tile) % across, int(tile) / across));
    ScreenTriangle t;
    if ((job.tile & kTriangleCrosses) != 0u) {
      drawCrossing(crossingTriangle(clip), pixels, thread, kTileGroup, job.triangle, d, instance);
    } else if (placeOnScreen(clip, t)) {
      const ivec4 bounds = pixelBounds(t);
      drawLarge(t, ivec4(max(pixels.xy, bounds.xy), min(pixels.zw, bounds.zw)), thread, kTileGroup, job.triangle, d, instance);
    }
  }
}
