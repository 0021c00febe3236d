// Samplers of directions: chi-square of what the shaders draw against the integral of the density that they state
// [correctness: statistical tests].
#include <gtest/gtest.h>

#include "chart.h"
#include "materials.h"
#include "shared/frame.h"
#include "support/hypothesis.h"

namespace helio::test {
namespace {

using shared::DirectionDensity;
using shared::DirectionDrawn;
using shared::DirectionQuestion;

constexpr double kAlpha = 0.01;

/// A sampler and the chart over which its density is integrated.
struct Case {
  std::string name;
  shared::ProbeConstants constants;
  glm::vec3 wo;
  Chart chart;
};

/// `tests`: how many cases share the significance.
void expectSampledAsStated(const Case& c, size_t tests) {
  // Integrate the density over each cell.
  std::vector<DirectionQuestion> questions;
  const std::vector<Chart::Node> nodes = c.chart.nodes();
  for (const Chart::Node& node : nodes) questions.push_back({c.wo, glm::vec3(node.direction)});
  const std::vector<DirectionDensity> density = densityOf(c.constants, questions);
  std::vector<double> expected(Chart::kCellCount + 1), observed(Chart::kCellCount + 1);
  double integral = 0.0;
  for (size_t i = 0; i < density.size(); ++i) {
    const double probability = static_cast<double>(density[i].pdf) * nodes[i].solid_angle;
    expected[i / Chart::kNodesPerCell] += static_cast<double>(kSamples) * probability;
    integral += probability;
  }
  EXPECT_LE(integral, 1.001) << c.name;
  // What the sampler gives up, below the horizon, is the last cell.
  expected.back() = static_cast<double>(kSamples) * std::max(0.0, 1.0 - integral);

  // Count, and ask for the density of each sample.
  const std::vector<DirectionDrawn> drawn = drawFrom(c.constants, c.wo);
  size_t mirrored = 0, outside = 0;
  questions.clear();
  for (const DirectionDrawn& d : drawn) {
    if (d.pdf == 0.0f) {
      observed.back() += 1.0;
      continue;
    }
    if (d.pdf < 0.0f) ++mirrored;
    const size_t cell = c.chart.cellOf(glm::dvec3(d.wi));
    if (cell == Chart::kCellCount) ++outside;
    observed[cell] += 1.0;
    questions.push_back({c.wo, d.wi});
  }
  EXPECT_EQ(mirrored, 0u) << c.name;
  EXPECT_EQ(outside, 0u) << c.name << ": drawn outside of where the density is positive";
  size_t impossible = 0;
  for (const DirectionDensity& d : densityOf(c.constants, questions)) impossible += !(d.pdf > 0.0f);
  // A disc of half a degree ends within rounding: its last 1e-5 may lie on either side.
  const size_t allowed = c.constants.routine == shared::kSampleSun ? kSamples / 10'000 : 0;
  EXPECT_LE(impossible, allowed) << c.name << ": samples of density 0";

  const ChiSquare test = chiSquare(observed, expected);
  EXPECT_GE(test.degrees, 10u) << c.name;
  EXPECT_GE(test.p, sidak(kAlpha, tests)) << c.name << ": chi-square " << test.statistic << " with " << test.degrees
                                          << " degrees of freedom, integral " << integral;
}

/// Narrow lobes around the mirror direction; near the horizon, which cuts them, along it.
Chart chartOf(const Material& material, const glm::vec3& wo) {
  if (material.lambert) return Chart::cap({0, 0, 1}, 0.5, 100.0);
  const double alpha = static_cast<double>(material.alpha()), cosine = static_cast<double>(wo.z);
  const glm::dvec3 mirrored(-wo.x, -wo.y, wo.z);
  if (cosine < 0.3) return Chart::horizon(mirrored, std::max(alpha, cosine), alpha * std::max(alpha, cosine));
  return Chart::cap(mirrored, 1.0, alpha * alpha);
}

std::vector<Case> bsdfCases(const std::vector<Material>& materials, const std::vector<double>& angles) {
  std::vector<Case> cases;
  for (const Material& material : materials)
    for (const double angle : angles) {
      const glm::vec3 wo = viewAt(angle);
      cases.push_back({material.name + " at " + std::to_string(angle) + " degrees", constantsOf(material), wo,
                       chartOf(material, wo)});
    }
  return cases;
}

TEST(Directions, LambertIsSampledAsStated) {
  const std::vector<Case> cases = bsdfCases({lambertOf(0.8f)}, {0.0, 89.0});
  for (const Case& c : cases) expectSampledAsStated(c, cases.size());
}

TEST(Directions, MetalIsSampledAsStated) {
  const std::vector<Case> cases =
      bsdfCases({metalOf(0.1f), metalOf(0.3f), metalOf(0.6f), metalOf(1.0f)}, {0.0, 45.0, 80.0, 89.0});
  for (const Case& c : cases) expectSampledAsStated(c, cases.size());
}

TEST(Directions, CoatedDiffuseIsSampledAsStated) {
  const std::vector<Case> cases =
      bsdfCases({dielectricOf(0.1f), dielectricOf(0.4f), dielectricOf(1.0f), mixedOf(0.3f)}, {0.0, 60.0, 88.0});
  for (const Case& c : cases) expectSampledAsStated(c, cases.size());
}

// Around the macrosurface's normal: the chart's sharpness is that of the distribution of normals.
TEST(Directions, VisibleNormalsAreSampledAsStated) {
  std::vector<Case> cases;
  for (const float roughness : {0.1f, 0.3f, 1.0f})
    for (const double angle : {0.0, 45.0, 89.0}) {
      shared::ProbeConstants constants = constantsOf(metalOf(roughness));
      constants.routine = shared::kSampleVisibleNormal;
      const double alpha = static_cast<double>(roughness * roughness);
      cases.push_back({"visible normals, roughness " + std::to_string(roughness) + ", " + std::to_string(angle),
                       constants, viewAt(angle), Chart::cap({0, 0, 1}, 0.5, 0.5 * alpha * alpha)});
    }
  for (const Case& c : cases) expectSampledAsStated(c, cases.size());
}

TEST(Directions, TheCosineHemisphereIsSampledAsStated) {
  shared::ProbeConstants constants{};
  constants.routine = shared::kSampleCosine;
  expectSampledAsStated({"cosine hemisphere", constants, glm::vec3(0, 0, 1), Chart::cap({0, 0, 1}, 0.5, 100.0)}, 1);
}

/// Frame constants on the GPU, for samplers that read them.
gpu::Buffer onGpu(const shared::FrameConstants& frame) {
  gpu::Buffer buffer(probe().device(), {"frame constants", sizeof(shared::FrameConstants),
                                        gpu::MemoryCategory::transfer, gpu::Placement::upload});
  std::memcpy(buffer.mapped(), &frame, sizeof frame);
  return buffer;
}

// Uniform, brighter above, black below, and brighter below; above the ground, a slope, a wall and a ceiling.
TEST(Directions, TheSkyIsSampledAsStated) {
  const std::vector<std::pair<glm::vec3, glm::vec3>> skies = {{glm::vec3(1.0f), glm::vec3(1.0f)},
                                                              {glm::vec3(0.4f, 0.6f, 2.0f), glm::vec3(0.3f)},
                                                              {glm::vec3(1.0f), glm::vec3(0.0f)},
                                                              {glm::vec3(0.0f), glm::vec3(0.5f, 0.4f, 0.1f)}};
  const std::vector<glm::dvec3> normals = {{0, 1, 0}, {0.6, 0.64, -0.48}, {1, 0, 0}, {0, -1, 0}};
  for (const auto& [zenith, ground] : skies) {
    shared::FrameConstants frame{};
    frame.sky_zenith = zenith;
    frame.sky_ground = ground;
    const gpu::Buffer buffer = onGpu(frame);
    shared::ProbeConstants constants{};
    constants.routine = shared::kSampleSky;
    constants.frame = buffer.address();
    for (const glm::dvec3& normal : normals)
      expectSampledAsStated({"sky from " + std::to_string(ground.x) + " to " + std::to_string(zenith.x) + ", normal " +
                                 std::to_string(normal.x) + " " + std::to_string(normal.y),
                             constants, glm::vec3(normal), Chart::cap(normal, 0.5, 100.0)},
                            skies.size() * normals.size());
  }
}

// The real sun's disc, the widest, and a sun straight below (where the basis has its branch).
TEST(Directions, TheSunIsSampledAsStated) {
  struct Disc {
    glm::dvec3 to;
    double diameter;
  };
  const std::vector<Disc> discs = {{{0.3, 0.8, -0.5}, 0.0093}, {{0.9, 0.1, 0.2}, 0.5}, {{0.0, 0.0, -1.0}, 0.05}};
  for (const Disc& disc : discs) {
    const double one_minus_cos = 2.0 * std::pow(std::sin(0.25 * disc.diameter), 2.0);
    shared::FrameConstants frame{};
    frame.sun_to = glm::vec3(glm::normalize(disc.to));
    frame.sun_one_minus_cos = static_cast<float>(one_minus_cos);
    const gpu::Buffer buffer = onGpu(frame);
    shared::ProbeConstants constants{};
    constants.routine = shared::kSampleSun;
    constants.frame = buffer.address();
    // The extent is the disc itself, rounded as the shader knows it.
    expectSampledAsStated(
        {"sun of " + std::to_string(disc.diameter) + " radians", constants, glm::vec3(0, 0, 1),
         Chart::cap(glm::dvec3(frame.sun_to), 0.5 * static_cast<double>(frame.sun_one_minus_cos), 1e6)},
        discs.size());
  }
}

}  // namespace
}  // namespace helio::test
