// The quick flight that benchmarks share.
#pragma once

#include "scene/scene.h"

namespace helio::bench {

/// Where the camera is after `share` of its way, [0, 1]: out from `start` and back in a wide arc, with a look to the
/// right and to the left, and down and up twice as often.
scene::Camera along(const scene::Camera& start, double share);

}  // namespace helio::bench
