// Which instances rays can meet: the strategies that are compared, one behind the other in one place.
#pragma once

#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include <glm/glm.hpp>

#include "shared/assemble.h"

namespace helio::accel {

/// A camera's claim on the world.
struct Viewpoint {
  shared::CullVolume volume;
  bool everything = false;  ///< a reference view: no approximation
  float tolerance = 0.0f;   ///< metres that a level of detail may be off, a metre away; 0: the finest alone
};

/// The volume that a camera sees: four inward planes through its position; the far plane is at infinity. The axes are
/// orthonormal, `tangent` is that of half the vertical angle.
shared::CullVolume frustumOf(const glm::vec3& position, const glm::vec3& right, const glm::vec3& up,
                             const glm::vec3& forward, float tangent, float aspect);

/// Whether a sphere touches the frustum.
bool inFrustum(const shared::CullVolume& volume, const glm::vec3& centre, float radius);

/// One a world. Deterministic: what it decides follows from the viewers, the instances and what it decided before.
class CullingStrategy {
 public:
  virtual ~CullingStrategy() = default;
  virtual std::string_view name() const = 0;

  /// This tick's viewers.
  virtual void begin(std::span<const Viewpoint> viewers) = 0;
  /// What the assembly tests every instance against, on the GPU; an instance enters the TLAS that touches one of them.
  /// Null: all enter.
  virtual const std::vector<shared::CullVolume>* volumes() const = 0;
  /// The same test, for what the CPU decides: BLASes of instances' own, blocks of instances.
  virtual bool wants(const glm::vec3& centre, float radius) const = 0;
};

/// Everything is in the TLAS.
std::unique_ptr<CullingStrategy> fullStrategy();

inline constexpr float kStrategyRadius = 800.0f;  ///< metres [Kelling §4.2]

/// What touches a viewer's frustum, or lies within `radius` metres of a viewer.
std::unique_ptr<CullingStrategy> frustumRadiusStrategy(float radius = kStrategyRadius);

/// What lies within `radius` metres of a viewer, wherever it looks.
std::unique_ptr<CullingStrategy> distanceStrategy(float radius);

}  // namespace helio::accel
