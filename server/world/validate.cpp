#include "world/validate.h"

#include <cmath>

#include <spdlog/fmt/fmt.h>

namespace helio::world {
namespace {

constexpr float kMaxScale = 1000.0f;
constexpr float kMaxAngularDiameter = 0.5f;
constexpr double kMaxTime = 1e9;  // seconds, 31 years: a double still has steps of 0.1 microseconds there
constexpr double kMaxRate = 100.0;
constexpr double kMinLength = 1e-12;  // of a quaternion or a direction: below it there is nothing to normalise

bool finite(const glm::vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

std::string text(const glm::vec3& v) { return fmt::format("({}, {}, {})", v.x, v.y, v.z); }

Error wrong(std::string field, std::string value, const std::string& rule, std::string limit = {}) {
  std::string message = "is " + value + ": " + rule;
  return {ErrorKind::invalid, std::move(message), std::move(field), std::move(value), std::move(limit)};
}

}  // namespace

Error at(const std::string& path, Error error) {
  error.field = error.field.empty() ? path : path + "." + error.field;
  error.message = error.field + " " + error.message;
  return error;
}

Result<Pose> checkedPose(const Pose& pose, float max_coordinate) {
  const glm::vec3& p = pose.position;
  if (!finite(p)) return wrong("position", text(p), "every coordinate must be a finite number of metres");
  if (std::fabs(p.x) > max_coordinate || std::fabs(p.y) > max_coordinate || std::fabs(p.z) > max_coordinate) {
    return wrong("position", text(p),
                 fmt::format("every coordinate must lie within {} m of the origin", max_coordinate),
                 fmt::format("{}", max_coordinate));
  }
  if (!std::isfinite(pose.scale) || pose.scale <= 0.0f || pose.scale > kMaxScale) {
    return wrong("scale", fmt::format("{}", pose.scale), fmt::format("it must lie in (0, {}]", kMaxScale),
                 fmt::format("{}", kMaxScale));
  }

  const glm::dquat q(pose.rotation.w, pose.rotation.x, pose.rotation.y, pose.rotation.z);
  const double length = std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
  if (!std::isfinite(length) || length < kMinLength) {
    return wrong("rotation", fmt::format("({}, {}, {}, {})", q.x, q.y, q.z, q.w),
                 "it must be a quaternion (x, y, z, w) of finite numbers that are not all zero");
  }
  Pose checked = pose;
  checked.rotation = glm::quat(static_cast<float>(q.w / length), static_cast<float>(q.x / length),
                               static_cast<float>(q.y / length), static_cast<float>(q.z / length));
  return checked;
}

Result<scene::Sun> checkedSun(const scene::Sun& sun) {
  const double length = glm::length(glm::dvec3(sun.direction));
  if (!std::isfinite(length) || length < kMinLength) {
    return wrong("direction", text(sun.direction), "it must be a vector of finite numbers that are not all zero");
  }
  const glm::vec3& e = sun.irradiance;
  if (!finite(e) || e.x < 0.0f || e.y < 0.0f || e.z < 0.0f) {
    return wrong("irradiance", text(e), "every component must be a finite number of W/m^2, 0 or more");
  }
  const float diameter = sun.angular_diameter;
  if (!std::isfinite(diameter) || diameter <= 0.0f || diameter > kMaxAngularDiameter) {
    return wrong("angular_diameter", fmt::format("{}", diameter),
                 fmt::format("it must lie in (0, {}] radians", kMaxAngularDiameter),
                 fmt::format("{}", kMaxAngularDiameter));
  }
  scene::Sun checked = sun;
  checked.direction = glm::vec3(glm::dvec3(sun.direction) / length);
  return checked;
}

Result<void> checkClock(const Clock& clock) {
  if (!(clock.time >= 0.0 && clock.time <= kMaxTime))
    return wrong("seek", fmt::format("{}", clock.time), fmt::format("world time must lie in [0, {}] seconds", kMaxTime),
                 fmt::format("{}", kMaxTime));
  if (!(clock.rate >= 0.0 && clock.rate <= kMaxRate))
    return wrong("rate", fmt::format("{}", clock.rate),
                 fmt::format("it must lie in [0, {}] seconds of world time a second", kMaxRate),
                 fmt::format("{}", kMaxRate));
  return {};
}

}  // namespace helio::world
