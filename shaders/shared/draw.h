// Rasterised primary hits: what one draw of a geometry's instances is told.
#ifndef HELIO_SHARED_DRAW_H
#define HELIO_SHARED_DRAW_H
#include "shared/types.h"

HELIO_SHARED_BEGIN

// Pushed before each draw; instances are `slots[gl_InstanceIndex]`.
struct DrawConstants {
  uint64_t frame;  // FrameConstants
  uint64_t slots;  // uint
  uint64_t positions;
  uint64_t indices;
  vec2 jitter;
  uint geometry;  // within the mesh
};

HELIO_SHARED_END
#endif
