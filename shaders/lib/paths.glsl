// Access to the queue of paths (shared/paths.h).
#ifndef HELIO_PATHS_GLSL
#define HELIO_PATHS_GLSL
#include "lib/tables.glsl"
#include "shared/paths.h"

layout(buffer_reference, scalar) buffer PathStateTable { PathState items[]; };
layout(buffer_reference, scalar) buffer PathPixelTable { uint items[]; };
layout(buffer_reference, scalar) buffer PathLaunchTable { PathLaunch items[]; };

// Two lists take turns: that of vertex k is read while that of vertex k + 1 is written.
uint listStart(uint scatterings) { return (scatterings & 1u) * frame.width * frame.height; }

PathLaunch pathLaunch(uint scatterings) { return PathLaunchTable(frame.path_launches).items[scatterings]; }

uvec2 queuedPixel(uint scatterings, uint index) {
  const uint pixel = PathPixelTable(frame.path_pixels).items[listStart(scatterings) + index];
  return uvec2(pixel % frame.width, pixel / frame.width);
}

void queuePixel(uint scatterings, uint index, uvec2 pixel) {
  PathPixelTable(frame.path_pixels).items[listStart(scatterings) + index] = pixel.y * frame.width + pixel.x;
}

#endif
