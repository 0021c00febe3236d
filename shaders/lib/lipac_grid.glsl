// The grid of hitboxes. `lipac` is the tick's constants (shared/lipac.h).
#ifndef HELIO_LIPAC_GRID_GLSL
#define HELIO_LIPAC_GRID_GLSL

uint spreadBits(uint x) {
  x = (x | x << 8) & 0x00ff00ffu;
  x = (x | x << 4) & 0x0f0f0f0fu;
  x = (x | x << 2) & 0x33333333u;
  return (x | x << 1) & 0x55555555u;
}
uint gatherBits(uint x) {
  x &= 0x55555555u;
  x = (x | x >> 1) & 0x33333333u;
  x = (x | x >> 2) & 0x0f0f0f0fu;
  x = (x | x >> 4) & 0x00ff00ffu;
  return (x | x >> 8) & 0x0000ffffu;
}
// kNoCell: outside.
uint cellAt(vec3 position) {
  const vec2 cell = floor(position.xz / float(kCellMetres)) - vec2(lipac.grid_x, lipac.grid_z);
  const vec2 sides = vec2(lipac.grid_blocks_x << kBlockBits, lipac.grid_blocks_z << kBlockBits);
  if (any(lessThan(cell, vec2(0.0))) || any(greaterThanEqual(cell, sides))) return kNoCell;
  const uvec2 at = uvec2(cell), block = at >> kBlockBits, within = at & ((1u << kBlockBits) - 1u);
  return (block.y * lipac.grid_blocks_x + block.x) << 2u * kBlockBits | spreadBits(within.x) | spreadBits(within.y) << 1;
}
// Its corner with the lowest x and z.
vec2 cellCorner(uint cell) {
  const uint block = cell >> 2u * kBlockBits, within = cell & ((1u << 2u * kBlockBits) - 1u);
  const uvec2 at = uvec2(block % lipac.grid_blocks_x, block / lipac.grid_blocks_x) << kBlockBits;
  return vec2(ivec2(at) + ivec2(gatherBits(within), gatherBits(within >> 1)) + ivec2(lipac.grid_x, lipac.grid_z)) *
         float(kCellMetres);
}

#endif
