// Access to the queue of paths (shared/paths.h).
#ifndef HELIO_PATHS_GLSL
#define HELIO_PATHS_GLSL
#include "lib/tables.glsl"
#include "shared/paths.h"

layout(buffer_reference, scalar) buffer PathStateTable { PathState items[]; };
layout(buffer_reference, scalar) buffer PathPixelTable { uint items[]; };
layout(buffer_reference, scalar) buffer PathLaunchTable { PathLaunch items[]; };

// Two lists take turns: that of launch k is read while that of launch k + 1 is written.
uint listStart(uint launch) { return (launch & 1u) * frame.width * frame.height; }

PathLaunch pathLaunch(uint launch) { return PathLaunchTable(frame.path_launches).items[launch]; }

uvec2 queuedPixel(uint launch, uint index) {
  const uint pixel = PathPixelTable(frame.path_pixels).items[listStart(launch) + index];
  return uvec2(pixel % frame.width, pixel / frame.width);
}

// All pixels of the picture one after another, by tiles of 8 x 4; false: beyond the last.
uint tilesOfPaths() { return (frame.width + 7u) / 8u * ((frame.height + 3u) / 4u); }
bool tiledPixel(uint index, out uvec2 pixel) {
  const uint tiles_x = (frame.width + 7u) / 8u, tile = index / 32u;
  pixel = uvec2(tile % tiles_x, tile / tiles_x) * uvec2(8u, 4u) + uvec2(index % 8u, index / 8u % 4u);
  return pixel.x < frame.width && pixel.y < frame.height;
}

void queuePixel(uint launch, uint index, uvec2 pixel) {
  PathPixelTable(frame.path_pixels).items[listStart(launch) + index] = pixel.y * frame.width + pixel.x;
}

#endif
