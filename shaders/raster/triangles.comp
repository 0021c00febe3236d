#version 460
#extension GL_GOOGLE_include_directive : require
// Rasterising, first: a thread a triangle. It draws what is small; of what is large it lists the tiles that it may touch, or the triangle
// where these are many.
#include "raster/parts.glsl"

layout(local_size_x = kTriangleGroup) in;

// False: there is no room.
bool leftToSpread(uint id) {
  RasterCountsRef header = rasterCounts();
  CounterTable list = spreadTriangles();
  const uint at = atomicAdd(header.counts.spread[raster.cascade], 1u);
  if (at >= spreadCapacity()) return false;
  list.items[at] = id;
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
  const Shape shape = shapeOf(clip);
  if (any(lessThan(shape.bounds.zw, shape.bounds.xy))) return;

  // What the screen cuts small may be large: its edge functions must fit.
  const ScreenTriangle t = shape.t;
  const ivec2 size = shape.bounds.zw - shape.bounds.xy + 1;
  if (!shape.crosses && uint(size.x * size.y) <= kSmallTriangle && longestSide(t) < 1 << 14)
    draw(t, shape.bounds, edgesAt(t, shape.bounds.xy), id, d, instance);
  else if (tileCount(shape) <= kFewTiles || !leftToSpread(id))
    listParts(shape, 0u, 1u, id, d, instance);
}
