#include "lib/camera.h"

#include <cmath>

namespace helio::client {

View lookAt(const glm::vec3& position, const glm::vec3& target, float vfov) {
  const glm::vec3 forward = glm::normalize(target - position);
  const glm::vec3 up = std::abs(forward.y) > 0.9999f ? glm::vec3(0, 0, -1) : glm::vec3(0, 1, 0);
  return {position, glm::quatLookAtRH(forward, up), vfov};
}

View between(const View& a, const View& b, float s) {
  const float eased = s * s * (3 - 2 * s);
  return {glm::mix(a.position, b.position, eased), glm::slerp(a.rotation, b.rotation, eased),
          glm::mix(a.vfov, b.vfov, eased)};
}

heliograph::v1::Camera toWire(const View& view) {
  heliograph::v1::Camera camera;
  const auto& p = view.position;
  const auto& r = view.rotation;
  for (const float number : {p.x, p.y, p.z, r.x, r.y, r.z, r.w}) camera.add_pose(number);
  camera.set_vfov(view.vfov);
  return camera;
}

View fromWire(const heliograph::v1::Camera& camera) {
  const auto& pose = camera.pose();
  return {{pose[0], pose[1], pose[2]}, glm::normalize(glm::quat(pose[6], pose[3], pose[4], pose[5])), camera.vfov()};
}

}  // namespace helio::client
