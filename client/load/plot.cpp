#include "load/plot.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace helio::load {
namespace {

constexpr float kStep = 1.0f / 64;  // metres between two placements' heights: exact in binary
constexpr uint64_t kHeights = 1u << 18;
constexpr uint32_t kSpots = 1024;  // of the sunflower pattern in which a plot fills

/// The farthest that a prefab's bounds reach from where it is placed, on the ground, metres.
float reach(const v1::Prefab& prefab) {
  const auto& low = prefab.bounds().min();
  const auto& high = prefab.bounds().max();
  return std::hypot(std::max(std::abs(low.x()), std::abs(high.x())), std::max(std::abs(low.z()), std::abs(high.z())));
}

}  // namespace

glm::ivec2 Plot::spiral(uint32_t index) {
  glm::ivec2 at(0), direction(1, 0);
  for (uint32_t side = 1, left = 1, turns = 0; index > 0; --index) {
    at += direction;
    if (--left > 0) continue;
    direction = {-direction.y, direction.x};
    if (++turns % 2 == 0) ++side;
    left = side;
  }
  return at;
}

Plot::Plot(std::string world, const v1::Bounds& bounds, uint32_t index) : world_(std::move(world)) {
  const glm::ivec2 cell = spiral(index);
  middle_ = {0.5f * (bounds.min().x() + bounds.max().x()) + kSpacing * float(cell.x),
             0.5f * (bounds.min().z() + bounds.max().z()) + kSpacing * float(cell.y)};
  ground_ = std::floor(bounds.max().y());  // above the roofs: it stands in nobody's way
}

float Plot::heightOf(uint64_t number) const { return ground_ + kStep * float(number % kHeights); }

v1::ApplyEditsRequest Plot::build(const std::string& prefab, uint32_t count) {
  v1::ApplyEditsRequest request;
  request.set_world(world_);
  auto& build = *request.add_edits()->mutable_build();
  build.set_prefab(prefab);
  for (uint32_t i = 0; i < count; ++i, ++next_) {
    const float spot = float(next_ % kSpots);
    const float angle = spot * std::numbers::pi_v<float> * (3 - std::sqrt(5.0f));
    const float radius = kBuildRadius * std::sqrt((spot + 0.5f) / kSpots);
    const glm::vec3 at(middle_.x + radius * std::cos(angle), heightOf(next_), middle_.y + radius * std::sin(angle));
    for (const float value : {at.x, at.y, at.z, 0.0f, 0.0f, 0.0f, 1.0f, 1.0f}) build.add_placements(value);
    placements_[next_] = State::unknown;
  }
  return request;
}

v1::ApplyEditsRequest Plot::destroy() const {
  v1::ApplyEditsRequest request;
  request.set_world(world_);
  auto& region = *request.add_edits()->mutable_destroy_region();
  region.set_x(middle_.x);
  region.set_z(middle_.y);
  region.set_radius(kRadius);
  return request;
}

void Plot::built(const v1::ApplyEditsRequest& request, const Result<v1::ApplyEditsResponse>& answer) {
  if (!answer) return;  // it may be there, or not
  const auto count = static_cast<uint64_t>(request.edits(0).build().placements_size()) / 8;
  for (uint64_t number = next_ - count; number < next_; ++number) placements_[number] = State::standing;
}

void Plot::destroyed(const Result<v1::ApplyEditsResponse>& answer) {
  for (auto& [number, state] : placements_)
    if (state != State::gone) state = answer ? State::gone : State::unknown;
}

Plot::Verdict Plot::verify(const std::vector<v1::Instance>& instances) const {
  std::map<uint64_t, uint64_t> there;  // how often, by height
  for (const auto& instance : instances) {
    const float steps = (instance.transform(10) - ground_) / kStep;
    if (steps >= 0 && steps < float(kHeights) && std::floor(steps) == steps) ++there[uint64_t(steps)];
  }
  // Heights come again after kHeights placements: what is expected at one is a range.
  struct Expected {
    uint64_t least = 0, most = 0;
  };
  std::map<uint64_t, Expected> expected;
  for (const auto& [number, state] : placements_) {
    auto& at = expected[number % kHeights];
    if (state == State::standing) ++at.least;
    if (state != State::gone) ++at.most;
  }
  Verdict verdict;
  for (const auto& [height, range] : expected) {
    const auto found = there.find(height);
    const uint64_t count = found == there.end() ? 0 : found->second;
    if (count < range.least) verdict.lost += range.least - count;
    // Destroyed, acknowledged, and there all the same; or built once and there twice.
    if (count > range.most) (range.most == 0 ? verdict.lost : verdict.doubled) += count - range.most;
  }
  return verdict;
}

Result<std::string> choosePrefab(const std::vector<v1::Prefab>& prefabs, const std::string& name) {
  const v1::Prefab* best = nullptr;
  for (const auto& prefab : prefabs) {
    if (!prefab.buildable() || reach(prefab) > Plot::kRadius - Plot::kBuildRadius) continue;
    if (!name.empty() ? prefab.name() == name : !best || reach(prefab) < reach(*best)) best = &prefab;
  }
  if (best) return best->name();
  return Error{ErrorKind::not_found,
               name.empty()
                   ? std::string("the world has no prefab that may be built and fits into a client's plot")
                   : "the world has no prefab \"" + name + "\" that may be built and fits into a client's plot",
               "prefab",
               name,
               {}};
}

}  // namespace helio::load
