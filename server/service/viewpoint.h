// Where a request for a picture looks from: shots and measurements of accuracy ask in the same words.
#pragma once

#include <algorithm>

#include "service/convert.h"

namespace helio::service {

/// `request.camera`, the world's named `request.camera_name`, or the world's first. Failures: a wrong field, an unknown
/// name.
template <typename Request>
Outcome<scene::Camera> viewpointOf(const Request& request, const scene::Scene& scene, const Limits& limits) {
  if (request.has_camera()) return fromWire(request.camera(), "request.camera", limits);
  if (request.view_case() != Request::kCameraName) return scene.cameras.front().camera;
  const auto named = std::find_if(scene.cameras.begin(), scene.cameras.end(),
                                  [&](const scene::NamedCamera& c) { return c.name == request.camera_name(); });
  if (named != scene.cameras.end()) return named->camera;
  return Failure(Error{ErrorKind::not_found,
                       "world \"" + request.world() + "\" has no camera \"" + request.camera_name() +
                           "\"; show the world to see their names",
                       "request.camera_name",
                       request.camera_name(),
                       {}});
}

}  // namespace helio::service
