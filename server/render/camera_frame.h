// A camera's axes, as raster, rays and culling share them.
#pragma once

#include <cmath>

#include "scene/scene.h"

namespace helio::render {

/// That a level of detail may differ from the finest, in pixels of the viewer who sees it largest. At a whole pixel
/// fences and kerbs stand one off, and with textures as fine as pixels that shows.
inline constexpr float kPixelsOff = 0.5f;

/// Orthonormal; `tangent` = tan(vfov / 2).
struct CameraFrame {
  glm::vec3 right, up, forward;
  float tangent;
};

inline CameraFrame cameraFrame(const scene::Camera& camera) {
  CameraFrame frame;
  frame.forward = glm::normalize(camera.forward);
  frame.right = glm::normalize(glm::cross(frame.forward, camera.up));
  frame.up = glm::cross(frame.right, frame.forward);
  frame.tangent = std::tan(0.5f * camera.vfov);
  return frame;
}

}  // namespace helio::render
