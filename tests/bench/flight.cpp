#include "bench/flight.h"

#include <cmath>

namespace helio::bench {

scene::Camera along(const scene::Camera& start, double share) {
  constexpr double kTurn = 6.283185307179586, kReach = 120.0, kYaw = 1.2, kPitch = 0.35;
  const glm::vec3 right = glm::normalize(glm::cross(start.forward, start.up));
  const auto swing = static_cast<float>(std::sin(kTurn * share)),
             out = static_cast<float>(std::sin(0.5 * kTurn * share));
  scene::Camera camera = start;
  camera.position +=
      static_cast<float>(kReach) * (out * right + 0.5f * swing * glm::vec3(start.forward.x, 0.0f, start.forward.z));
  const float yaw = static_cast<float>(kYaw) * swing;
  const float pitch = static_cast<float>(kPitch * std::sin(2.0 * kTurn * share));
  const glm::vec3 turned = std::cos(yaw) * start.forward + std::sin(yaw) * right;
  camera.forward = glm::normalize(turned + pitch * glm::vec3(0.0f, 1.0f, 0.0f));
  return camera;
}

}  // namespace helio::bench
