// Sampling of lamps: the instance by the light grid, the triangle by its power, the point by area; each against the
// density that the path tracer's weights rest on when a ray meets the same point [correctness: light selection].
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "lamps.h"
#include "probe.h"
#include "support/hypothesis.h"
#include "support/scenes.h"

namespace helio::test {
namespace {

using shared::EmitterDensity;
using shared::EmitterDrawn;
using shared::EmitterQuestion;

constexpr double kAlpha = 0.01;
constexpr double kN = static_cast<double>(kSamples);

/// More lamps within one cell's reach than its list holds, of powers from 1 to 400 and of three meshes; one of them
/// scaled unevenly, one mirrored, one a kilometre away. The two-coloured box shines with two materials, and not all
/// over.
scene::ScenePtr street() {
  SceneBuilder b;
  const uint32_t ball = b.prefab("ball", sphere(3), b.material(lambert(glm::vec3(0.5f), {10.0f, 8.0f, 6.0f})));
  const uint32_t panel = b.prefab("panel", quad(1.0f), b.material(lambert(glm::vec3(0.0f), glm::vec3(3.0f))));
  const uint32_t box = b.prefab("box", cube(), b.material(lambert(glm::vec3(0.2f), {0.0f, 2.0f, 0.0f})));
  const uint32_t stone = b.prefab("stone", cube(), b.material(lambert(glm::vec3(0.6f))));
  for (uint32_t i = 0; i < 18; ++i)
    b.place(ball, at({3.0f * static_cast<float>(i) - 20.0f, 4.0f, static_cast<float>(i % 3)},
                     0.1f * (1.0f + static_cast<float>(i % 7))));
  b.place(stone, at({0, 0, 0}));
  b.place(panel, glm::mat4x3(glm::vec3(3, 0, 0), glm::vec3(0, 1, 0), glm::vec3(0, 0, 0.2f), glm::vec3(5, 3, 5)));
  b.place(panel, glm::mat4x3(glm::vec3(-1, 0, 0), glm::vec3(0, 0.5f, 0), glm::vec3(0, 0, 1), glm::vec3(-5, 3, 5)));
  b.place(box,
          glm::mat4x3(glm::vec3(0.5f, 0, 0.5f), glm::vec3(0, 2, 0), glm::vec3(-0.3f, 0, 0.3f), glm::vec3(0, 2, 9)));
  b.place(box, at({1000.0f, 2.0f, 0.0f}, 5.0f));
  return b.build();
}

/// Where lights are chosen from: amid the street, at its end, near the far lamp, between both where nothing is listed,
/// and outside of the grid.
const std::vector<glm::vec3> kPlaces = {
    {0.0f, 0.0f, 2.0f}, {60.0f, 1.0f, 20.0f}, {990.0f, 0.0f, 5.0f}, {500.0f, 0.0f, 0.0f}, {-5000.0f, 10.0f, 0.0f}};

std::vector<EmitterDensity> densityOf(const Lamps& lamps, const std::vector<EmitterQuestion>& questions) {
  return probe().ask<EmitterDensity, EmitterQuestion>("emitter_density.comp", lamps.constants(), questions);
}
std::vector<EmitterDrawn> drawFrom(const Lamps& lamps, const glm::vec3& p) {
  return probe().ask<EmitterDrawn, EmitterQuestion>("sample_emitter.comp", lamps.constants(),
                                                    std::vector<EmitterQuestion>(kSamples, {p, 0, 0, 0, {}}));
}

class Emitters : public testing::Test {
 protected:
  static void SetUpTestSuite() { lamps = new Lamps(street()); }
  static void TearDownTestSuite() { delete lamps; }
  static Lamps* lamps;
};
Lamps* Emitters::lamps = nullptr;

TEST_F(Emitters, AnInstanceIsChosenAsOftenAsStated) {
  const std::vector<uint32_t> slots = lamps->slots();
  ASSERT_EQ(slots.size(), 22u);
  for (const glm::vec3& p : kPlaces) {
    std::vector<EmitterQuestion> questions;
    for (const uint32_t slot : slots) questions.push_back({p, slot, 0, 0, {0.3f, 0.3f}});
    const std::vector<EmitterDensity> stated = densityOf(*lamps, questions);
    std::vector<double> expected, observed(slots.size());
    double sum = 0.0;
    for (const EmitterDensity& d : stated) {
      EXPECT_GT(d.slot_probability, 0.0f) << "a lamp that can never be chosen";
      expected.push_back(kN * static_cast<double>(d.slot_probability));
      sum += static_cast<double>(d.slot_probability);
    }
    EXPECT_NEAR(sum, 1.0, 1e-4);
    for (const EmitterDrawn& d : drawFrom(*lamps, p)) {
      const auto found = std::find(slots.begin(), slots.end(), d.slot);
      ASSERT_NE(found, slots.end()) << "slot " << d.slot << " does not shine";
      observed[static_cast<size_t>(found - slots.begin())] += 1.0;
    }
    const ChiSquare test = chiSquare(observed, expected);
    EXPECT_GE(test.p, sidak(kAlpha, kPlaces.size()))
        << "from x = " << p.x << ": chi-square " << test.statistic << " with " << test.degrees << " degrees of freedom";
  }
}

/// Each triangle in 4 x 4 parts of equal area: in the square that folds into it, x = (b1 + b2)^2 and y = b2 / (b1 +
/// b2).
constexpr size_t kSide = 4;

glm::dvec2 unfold(const glm::dvec2& square) {
  const double root = std::sqrt(square.x);
  return {root * (1.0 - square.y), root * square.y};
}
size_t partOf(const glm::dvec3& located) {
  const double sum = std::clamp(located.x + located.y, 1e-9, 1.0);
  const auto index = [](double v) {
    return std::min(kSide - 1, static_cast<size_t>(std::max(0.0, v) * static_cast<double>(kSide)));
  };
  return index(sum * sum) * kSide + index(located.y / sum);
}

TEST_F(Emitters, PointsAreChosenAsOftenAsStatedWhereARayMeetsThem) {
  const std::vector<LampTriangle>& triangles = lamps->triangles();
  // The density per area is constant over a triangle: ask at the middle of each part all the same.
  std::vector<glm::dvec2> middles;
  for (size_t i = 0; i < kSide * kSide; ++i)
    middles.push_back(
        unfold({(static_cast<double>(i / kSide) + 0.5) / kSide, (static_cast<double>(i % kSide) + 0.5) / kSide}));
  for (const glm::vec3& p : kPlaces) {
    std::vector<EmitterQuestion> questions;
    for (const LampTriangle& t : triangles)
      for (const glm::dvec2& middle : middles)
        questions.push_back({p, t.slot, t.geometry, t.primitive, glm::vec2(middle)});
    const std::vector<EmitterDensity> stated = densityOf(*lamps, questions);
    std::vector<double> expected, observed(stated.size());
    double integral = 0.0;
    for (size_t i = 0; i < stated.size(); ++i) {
      const LampTriangle& triangle = triangles[i / middles.size()];
      const double part = triangle.area() / static_cast<double>(middles.size());
      expected.push_back(kN * static_cast<double>(stated[i].pdf_area) * part);
      integral += static_cast<double>(stated[i].pdf_area) * part;
      const glm::dvec3 truth = triangle.at(middles[i % middles.size()]);
      ASSERT_LT(glm::distance(glm::dvec3(stated[i].position), truth), 1e-3) << "the harness met another point";
    }
    EXPECT_NEAR(integral, 1.0, 1e-3);

    size_t astray = 0, disagreeing = 0;
    for (const EmitterDrawn& d : drawFrom(*lamps, p)) {
      // The triangle of the chosen instance whose plane and outline hold the point.
      size_t found = triangles.size();
      double least = 1e-3 * (1.0 + std::abs(static_cast<double>(d.position.x)) / 1000.0);
      for (size_t t = 0; t < triangles.size(); ++t) {
        if (triangles[t].slot != d.slot) continue;
        const glm::dvec3 at = triangles[t].locate(glm::dvec3(d.position));
        const double outside = std::max({-at.x, -at.y, at.x + at.y - 1.0, 0.0});
        if (at.z + outside < least) least = at.z + outside, found = t;
      }
      if (found == triangles.size()) {
        ++astray;
        continue;
      }
      const size_t cell = found * middles.size() + partOf(triangles[found].locate(glm::dvec3(d.position)));
      observed[cell] += 1.0;
      disagreeing += !(std::abs(d.pdf_area - stated[cell].pdf_area) <= 1e-3f * d.pdf_area);
    }
    EXPECT_EQ(astray, 0u) << "points that lie on no triangle of the chosen instance";
    EXPECT_EQ(disagreeing, 0u) << "points whose density is another when a ray meets them";
    const ChiSquare test = chiSquare(observed, expected);
    EXPECT_GE(test.p, sidak(kAlpha, kPlaces.size()))
        << "from x = " << p.x << ": chi-square " << test.statistic << " with " << test.degrees << " degrees of freedom";
  }
}

TEST_F(Emitters, APointShinesAsItsMaterialDoes) {
  for (const EmitterDrawn& d : drawFrom(*lamps, kPlaces[0])) {
    const bool ball = d.emission == glm::vec3(10.0f, 8.0f, 6.0f), panel = d.emission == glm::vec3(3.0f),
               box = d.emission == glm::vec3(0.0f, 2.0f, 0.0f);
    ASSERT_TRUE(ball || panel || box) << d.emission.x << " " << d.emission.y << " " << d.emission.z;
  }
}

}  // namespace
}  // namespace helio::test
