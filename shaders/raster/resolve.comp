#version 460
#extension GL_GOOGLE_include_directive : require
// Rasterising, last: who was the nearest becomes what the visibility image says.
#include "raster/raster.glsl"
#include "lib/hit.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

void main() {
  const uvec2 pixel = gl_GlobalInvocationID.xy;
  if (any(greaterThanEqual(pixel, uvec2(raster.width, raster.height)))) return;
  const uint64_t key = KeyTable(raster.keys).items[pixel.y * raster.width + pixel.x];
  Hit hit = Hit(0u, 0u, kNothing, vec2(0.0), 0u);
  if (key != 0ul) {
    const Drawn d = drawnTriangle(uint(key));
    hit = Hit(d.slot, d.record.geometry, d.primitive, vec2(0.0), d.record.level);
  }
  imageStore(images_rg32ui[frame.visibility], ivec2(pixel), uvec4(packHit(hit), 0u, 0u));
}
