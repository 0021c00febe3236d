// The lie of the land: size, town, woods, heights.
#include <algorithm>
#include <cmath>

#include "scene/city_plan.h"
#include "scene/random.h"

namespace helio::scene {
namespace {

constexpr double kMetresPerRootInstance = 7.5;  // side = 7.5 m * sqrt(instances): 4.5 instances in a hitbox cell

double ease(double low, double high, double x) {
  const double t = std::clamp((x - low) / (high - low), 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

}  // namespace

Site::Site(const CityParameters& parameters) : seed(parameters.seed) {
  const double wanted = kMetresPerRootInstance * std::sqrt(static_cast<double>(parameters.instances));
  side = kTile * std::max(4.0, std::floor(wanted / kTile + 0.5));
  apron = std::clamp(0.6 * side, 240.0, 2400.0);
  town_centre = glm::dvec2(-0.11, 0.06) * side;
  town_radius = 0.28 * side + 14.0;
  square_half = std::clamp(0.045 * side, 23.0, 34.0);
}

double Site::urbanity(const glm::dvec2& p) const {
  const glm::dvec2 offset = p - town_centre;
  const double wobble =
      0.24 * fractalNoise(hash64(seed, 1), offset.x / town_radius * 1.6, offset.y / town_radius * 1.6, 2);
  return 1.0 - glm::length(offset) / (town_radius * (1.0 + wobble));
}

double Site::woodland(const glm::dvec2& p) const {
  const glm::dvec2 q = p / half();
  const double edge = std::max(std::abs(q.x), std::abs(q.y));
  const double noise = fractalNoise(hash64(seed, 2), q.x * 2.6, q.y * 2.6, 3);
  return 0.95 * glm::dot(q - town_centre / half(), glm::dvec2(0.93, -0.36)) + 0.6 * noise + 0.25 * edge * edge * edge -
         0.60;
}

HeightField::HeightField(const Site& site) : site_(site), count_(static_cast<int64_t>(site.side / kLattice) + 1) {
  samples_.resize(static_cast<size_t>(count_ * count_));
  for (int64_t iz = 0; iz < count_; ++iz) {
    for (int64_t ix = 0; ix < count_; ++ix) {
      const glm::dvec2 p = glm::dvec2(ix, iz) * kLattice - site_.half();
      samples_[static_cast<size_t>(iz * count_ + ix)] = static_cast<float>(shape(p));
    }
  }
}

double HeightField::shape(const glm::dvec2& p) const {
  const double away = glm::distance(p, site_.town_centre) / site_.town_radius;
  const double country = ease(0.75, 1.7, away);
  const double rolling = fractalNoise(hash64(site_.seed, 3), p.x / 170.0, p.y / 170.0, 2);
  const double wave = std::max(330.0, 0.16 * site_.side);  // hills grow with the world, their slopes do not
  const double hills = fractalNoise(hash64(site_.seed, 4), p.x / wave, p.y / wave, 3);
  const double beyond = std::max(0.0, std::max(std::abs(p.x), std::abs(p.y)) - site_.half()) / site_.apron;
  const double rim = ease(0.0, 1.0, beyond) * site_.apron *
                     (0.15 + 0.07 * valueNoise(hash64(site_.seed, 5), p.x / wave * 1.3, p.y / wave * 1.3));
  return (1.6 + 1.2 * country) * rolling + 0.040 * wave * country * hills + rim;
}

double HeightField::sample(int64_t ix, int64_t iz) const {
  if (ix >= 0 && iz >= 0 && ix < count_ && iz < count_) return samples_[static_cast<size_t>(iz * count_ + ix)];
  return shape(glm::dvec2(ix, iz) * kLattice - site_.half());
}

double HeightField::height(const glm::dvec2& p) const {
  const glm::dvec2 q = (p + site_.half()) / kLattice, cell = glm::floor(q), t = q - cell;
  const auto ix = static_cast<int64_t>(cell.x), iz = static_cast<int64_t>(cell.y);
  const double h00 = sample(ix, iz), h11 = sample(ix + 1, iz + 1);
  if (t.x >= t.y) {
    const double h10 = sample(ix + 1, iz);
    return h00 + t.x * (h10 - h00) + t.y * (h11 - h10);
  }
  const double h01 = sample(ix, iz + 1);
  return h00 + t.y * (h01 - h00) + t.x * (h11 - h01);
}

HeightGrid HeightField::grid() const {
  return {glm::vec2(static_cast<float>(-site_.half())), static_cast<float>(kLattice), static_cast<uint32_t>(count_),
          samples_};
}

glm::vec3 HeightField::normal(const glm::dvec2& p) const {
  const auto at = [&](double dx, double dz) { return height(p + glm::dvec2(dx, dz)); };
  const double d = kLattice;
  return glm::vec3(glm::normalize(glm::dvec3(at(-d, 0) - at(d, 0), 2.0 * d, at(0, -d) - at(0, d))));
}

double HeightField::lowest(const Rectangle& rectangle) const {
  double low = height(rectangle.centre);
  for (const glm::dvec2& corner : rectangle.corners()) low = std::min(low, height(corner));
  return low;
}

double HeightField::highest(const Rectangle& rectangle) const {
  double high = height(rectangle.centre);
  for (const glm::dvec2& corner : rectangle.corners()) high = std::max(high, height(corner));
  return high;
}

}  // namespace helio::scene
