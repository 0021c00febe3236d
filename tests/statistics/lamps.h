// A scene that shines, as the tables of which the shaders choose its lights.
#pragma once

#include "accel/instance_table.h"
#include "render/emitter_instances.h"
#include "render/scene_resources.h"
#include "scene/scene.h"
#include "shaders/probe.h"
#include "world/world.h"

namespace helio::test {

/// One emissive triangle of a placed instance, in world space.
struct LampTriangle {
  uint32_t slot, geometry, primitive;
  glm::dvec3 p[3];

  double area() const { return 0.5 * glm::length(glm::cross(p[1] - p[0], p[2] - p[0])); }
  glm::dvec3 at(const glm::dvec2& barycentrics) const {
    return p[0] + barycentrics.x * (p[1] - p[0]) + barycentrics.y * (p[2] - p[0]);
  }
  /// Barycentrics of the nearest point of its plane, and the distance to the plane.
  glm::dvec3 locate(const glm::dvec3& q) const;
};

/// Uploads a scene for the probe's device.
class Lamps {
 public:
  explicit Lamps(scene::ScenePtr scene);

  /// What a probe is pushed to see this scene.
  shared::ProbeConstants constants() const;
  const std::vector<LampTriangle>& triangles() const { return triangles_; }
  std::vector<uint32_t> slots() const;  ///< of instances that shine

 private:
  void findTriangles();

  scene::ScenePtr scene_;
  gpu::Commands commands_;
  render::SceneResources resources_;
  accel::InstanceTable instances_;
  render::EmitterInstances emitters_;
  gpu::Buffer frame_;
  std::vector<LampTriangle> triangles_;
};

}  // namespace helio::test
