// Cameras on the wire: position and rotation, looking along -z.
#pragma once

#include <heliograph/v1/common.pb.h>

#include <glm/gtc/quaternion.hpp>
#include <glm/vec3.hpp>

namespace helio::client {

struct View {
  glm::vec3 position{0.0f};
  glm::quat rotation{1.0f, 0.0f, 0.0f, 0.0f};  ///< unit
  float vfov = 1.0f;                           ///< radians, full vertical angle

  glm::vec3 forward() const { return rotation * glm::vec3(0, 0, -1); }
};

/// From `position` towards `target`, y up; straight up or down: -z up. The two may not be the same point.
View lookAt(const glm::vec3& position, const glm::vec3& target, float vfov);

/// Between two views, s in [0, 1]: position along a line, rotation along the shorter arc, both eased in and out.
View between(const View& a, const View& b, float s);

heliograph::v1::Camera toWire(const View& view);
/// `camera.pose` has seven numbers.
View fromWire(const heliograph::v1::Camera& camera);

}  // namespace helio::client
