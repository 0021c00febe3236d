#include "accel/strategy.h"

#include <algorithm>
#include <cmath>

namespace helio::accel {
namespace {

class Full final : public CullingStrategy {
 public:
  std::string_view name() const override { return "full"; }
  void begin(std::span<const Viewpoint>) override {}
  const std::vector<shared::CullVolume>* volumes() const override { return nullptr; }
  bool wants(const glm::vec3&, float) const override { return true; }
};

/// In the place of a frustum: inwards from the sides of a tetrahedron around the viewer, which holds nothing that the
/// radius does not.
void seeNothing(shared::CullVolume& volume) {
  const float third = 1.0f / std::sqrt(3.0f);
  volume.sides[0] = glm::vec3(third, third, third);
  volume.sides[1] = glm::vec3(third, -third, -third);
  volume.sides[2] = glm::vec3(-third, third, -third);
  volume.sides[3] = glm::vec3(-third, -third, third);
}

class FrustumRadius final : public CullingStrategy {
 public:
  FrustumRadius(float radius, bool frustum) : radius_(radius), frustum_(frustum) {}
  std::string_view name() const override { return frustum_ ? "frustum_radius" : "distance"; }

  void begin(std::span<const Viewpoint> viewers) override {
    volumes_.clear();
    everything_ = std::any_of(viewers.begin(), viewers.end(), [](const Viewpoint& v) { return v.everything; });
    for (const Viewpoint& viewer : viewers) {
      volumes_.push_back(viewer.volume);
      volumes_.back().radius = radius_;
      if (!frustum_) seeNothing(volumes_.back());
    }
  }
  const std::vector<shared::CullVolume>* volumes() const override { return everything_ ? nullptr : &volumes_; }
  bool wants(const glm::vec3& centre, float radius) const override {
    return everything_ || std::any_of(volumes_.begin(), volumes_.end(), [&](const shared::CullVolume& v) {
             return glm::distance(centre, v.position) < v.radius + radius || inFrustum(v, centre, radius);
           });
  }

 private:
  float radius_;
  bool frustum_;
  bool everything_ = false;
  std::vector<shared::CullVolume> volumes_;
};

}  // namespace

bool inFrustum(const shared::CullVolume& volume, const glm::vec3& centre, float radius) {
  return std::all_of(std::begin(volume.sides), std::end(volume.sides),
                     [&](const glm::vec3& side) { return glm::dot(side, centre - volume.position) > -radius; });
}

shared::CullVolume frustumOf(const glm::vec3& position, const glm::vec3& right, const glm::vec3& up,
                             const glm::vec3& forward, float tangent, float aspect) {
  const auto side = [&](const glm::vec3& axis, float half) {
    return (forward * half - axis) / std::sqrt(1.0f + half * half);
  };
  shared::CullVolume volume{};
  volume.position = position;
  volume.sides[0] = side(right, tangent * aspect);
  volume.sides[1] = side(-right, tangent * aspect);
  volume.sides[2] = side(up, tangent);
  volume.sides[3] = side(-up, tangent);
  return volume;
}

std::unique_ptr<CullingStrategy> fullStrategy() { return std::make_unique<Full>(); }

std::unique_ptr<CullingStrategy> frustumRadiusStrategy(float radius) {
  return std::make_unique<FrustumRadius>(radius, true);
}

std::unique_ptr<CullingStrategy> distanceStrategy(float radius) {
  return std::make_unique<FrustumRadius>(radius, false);
}

}  // namespace helio::accel
