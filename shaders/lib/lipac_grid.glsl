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
  const float side = float(1u << lipac.grid_bits);
  if (any(lessThan(cell, vec2(0.0))) || any(greaterThanEqual(cell, vec2(side)))) return kNoCell;
  return spreadBits(uint(cell.x)) | spreadBits(uint(cell.y)) << 1;
}
// Its corner with the lowest x and z.
vec2 cellCorner(uint cell) {
  return vec2(int(gatherBits(cell)) + lipac.grid_x, int(gatherBits(cell >> 1)) + lipac.grid_z) * float(kCellMetres);
}

#endif
