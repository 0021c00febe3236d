// What may be shown of light path guided culling, in the picture's place.
#ifndef HELIO_SHARED_CULLING_VIEW_H
#define HELIO_SHARED_CULLING_VIEW_H
#include "shared/types.h"

HELIO_SHARED_BEGIN

HELIO_CONSTANT kCullingViewNone = 0u;
HELIO_CONSTANT kCullingViewStates = 1u;    // inactive blue, omitted yellow, requested red, active green
HELIO_CONSTANT kCullingViewHitboxes = 2u;  // under the first surface: inactive blue, active green; brighter by hits
HELIO_CONSTANT kCullingViewUntraced = 3u;  // drawn, but rays do not meet it: orange
HELIO_CONSTANT kCullingViewRays = 4u;  // of this tick: bounces red, shadow rays green, second tries blue; 8 are full
HELIO_CONSTANT kCullingViewAbove =
    5u;  // the world from above, hitboxes by hits: active from red to white, inactive blue
HELIO_CONSTANT kCullingViews = 6u;

HELIO_SHARED_END
#endif
