// Checks of the numbers in edits. The errors' fields and messages begin at the value checked; at() puts the path
// before.
#pragma once

#include <string>

#include "base/result.h"
#include "scene/scene.h"
#include "world/world.h"

namespace helio::world {

/// The same error, `path` before its field and the whole field before its message:
/// "edits[3].build.poses[7].scale" and "edits[3].build.poses[7].scale is -1: it must lie in (0, 1000]".
Error at(const std::string& path, Error error);

/// The pose with its rotation normalised. Errors (invalid): numbers that are not finite, a position farther than
/// `max_coordinate` from the origin along an axis, a rotation of length zero, a scale outside (0, 1000].
Result<Pose> checkedPose(const Pose& pose, float max_coordinate);

/// The sun with its direction normalised. Errors (invalid): numbers that are not finite, a direction of length zero, a
/// negative irradiance, an angular diameter outside (0, 0.5].
Result<scene::Sun> checkedSun(const scene::Sun& sun);

/// Errors (invalid): a time outside [0, 1e9] s, a rate outside [0, 100], numbers that are not finite.
Result<void> checkClock(const Clock& clock);

}  // namespace helio::world
