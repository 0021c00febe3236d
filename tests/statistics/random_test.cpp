// Random numbers: each uniform, and neighbours of any kind independent.
#include <gtest/gtest.h>

#include <functional>

#include "probe.h"
#include "shared/frame.h"
#include "support/hypothesis.h"

namespace helio::test {
namespace {

using shared::RandomQuestion;

std::vector<glm::vec4> numbersAt(const std::vector<RandomQuestion>& questions) {
  return probe().ask<glm::vec4, RandomQuestion>("random.comp", {}, questions);
}

size_t bin(float u, size_t bins) { return static_cast<size_t>(u * static_cast<float>(bins)); }

/// p-value of "the pairs fill the unit square evenly", which holds when both are uniform and independent.
double evenly(const std::vector<float>& a, const std::vector<float>& b) {
  constexpr size_t kBins = 64;
  std::vector<double> observed(kBins * kBins);
  const std::vector<double> expected(observed.size(),
                                     static_cast<double>(a.size()) / static_cast<double>(observed.size()));
  for (size_t i = 0; i < a.size(); ++i) observed.at(bin(a[i], kBins) * kBins + bin(b[i], kBins)) += 1.0;
  return chiSquare(observed, expected).p;
}

std::vector<float> component(const std::vector<glm::vec4>& numbers, int c) {
  std::vector<float> result;
  for (const glm::vec4& v : numbers) result.push_back(v[c]);
  return result;
}

/// Pictures of 100 x 100 pixels, 20 samples, 5 dimensions from `first_sample` and `first_dimension` on.
std::vector<RandomQuestion> grid(uint32_t first_sample, uint32_t first_dimension) {
  std::vector<RandomQuestion> questions;
  for (uint32_t dimension = 0; dimension < 5; ++dimension)
    for (uint32_t sample = 0; sample < 20; ++sample)
      for (uint32_t y = 0; y < 100; ++y)
        for (uint32_t x = 0; x < 100; ++x)
          questions.push_back({x, y, first_sample + sample, first_dimension + dimension});
  return questions;
}

TEST(Random, NumbersLieInTheUnitInterval) {
  for (const glm::vec4& v : numbersAt(grid(0, 0)))
    for (int c = 0; c < 4; ++c) {
      ASSERT_GE(v[c], 0.0f);
      ASSERT_LT(v[c], 1.0f);
    }
}

// One number against another of the same draw, and against the same of the next pixel, row, sample and dimension: each
// chi-square over 64 x 64 cells also tests that both are uniform.
TEST(Random, NeighboursAreUniformAndIndependent) {
  struct Neighbour {
    const char* name;
    std::function<void(RandomQuestion&)> step;
  };
  const std::vector<Neighbour> neighbours = {
      {"the pixel to the right", [](RandomQuestion& q) { q.x += 1; }},
      {"the pixel below", [](RandomQuestion& q) { q.y += 1; }},
      {"the diagonal pixel", [](RandomQuestion& q) { ++q.x, ++q.y; }},
      {"the next sample", [](RandomQuestion& q) { q.sample_index += 1; }},
      {"the 256th next sample", [](RandomQuestion& q) { q.sample_index += 256; }},
      {"the next dimension", [](RandomQuestion& q) { q.dimension += 1; }},
      {"the next sample, one dimension back", [](RandomQuestion& q) { ++q.sample_index, --q.dimension; }}};
  const size_t tests = 4 * neighbours.size() + 6;
  const std::vector<RandomQuestion> here = grid(3, 1);
  const std::vector<glm::vec4> numbers = numbersAt(here);
  for (int c = 0; c < 4; ++c)
    for (int d = c + 1; d < 4; ++d)
      EXPECT_GE(evenly(component(numbers, c), component(numbers, d)), sidak(0.01, tests)) << c << " and " << d;
  for (const Neighbour& neighbour : neighbours) {
    std::vector<RandomQuestion> there = here;
    for (RandomQuestion& q : there) neighbour.step(q);
    const std::vector<glm::vec4> others = numbersAt(there);
    for (int c = 0; c < 4; ++c)
      EXPECT_GE(evenly(component(numbers, c), component(others, c)), sidak(0.01, tests))
          << "component " << c << " and that of " << neighbour.name;
  }
}

// A path that runs for hours: sample indices near the end of their range are as good as the first.
TEST(Random, LateSamplesAreUniform) {
  const std::vector<glm::vec4> numbers = numbersAt(grid(0xffffff00u, 200));
  EXPECT_GE(evenly(component(numbers, 0), component(numbers, 1)), sidak(0.01, 2));
  EXPECT_GE(evenly(component(numbers, 2), component(numbers, 3)), sidak(0.01, 2));
}

// ---- Low-discrepancy samples ----

/// Samples of lib/sampler.glsl for blocks of 2^log2_samples a pixel: xy the point, z the number beside it.
std::vector<glm::vec4> pathSamplesAt(const std::vector<RandomQuestion>& questions, uint32_t seed,
                                     uint32_t log2_samples) {
  const gpu::Buffer buffer(probe().device(), {"frame constants", sizeof(shared::FrameConstants),
                                              gpu::MemoryCategory::transfer, gpu::Placement::upload});
  const shared::FrameConstants frame{};  // independent_samples: 0
  std::memcpy(buffer.mapped(), &frame, sizeof frame);
  shared::ProbeConstants constants{};
  constants.frame = buffer.address();
  constants.seed = seed;
  constants.log2_samples = log2_samples;
  return probe().ask<glm::vec4, RandomQuestion>("path_sample.comp", constants, questions);
}

// The samples of a pixel are a (0, 6, 2)-net in base 2: each of the 64 dyadic boxes of area 1 / 64, of every shape,
// holds one point. The first and the later blocks, in every pixel, for every decision.
TEST(PathSamples, APixelsBlockIsANet) {
  for (const uint32_t first_sample : {0u, 64u, 640u})
    for (uint32_t pixel = 0; pixel < 200; ++pixel) {
      std::vector<RandomQuestion> questions;
      const uint32_t decision = 1 + pixel % 60;
      for (uint32_t i = 0; i < 64; ++i)
        questions.push_back({pixel * 37 % 1000, pixel * 101 % 700, first_sample + i, decision});
      const std::vector<glm::vec4> points = pathSamplesAt(questions, 5, 6);
      for (uint32_t columns = 1; columns <= 64; columns *= 2) {
        std::vector<int> held(64);
        const uint32_t rows = 64 / columns;
        for (const glm::vec4& p : points) ++held.at(bin(p.x, columns) * rows + bin(p.y, rows));
        for (const int n : held) ASSERT_EQ(n, 1) << "pixel " << pixel << ", " << columns << " columns";
      }
    }
}

// A path's decisions are padded pairs of one sequence, each with a shuffle and scrambles of its own: the point of one
// must say nothing about the point of another. Every pair of the decisions that a path takes first, every pair of
// coordinates.
TEST(PathSamples, DecisionsAreIndependent) {
  // Position in the pixel; then, of four vertices, the points of sun and lamp, the direction, and the lobe.
  std::vector<uint32_t> decisions{0};
  for (uint32_t vertex = 1; vertex <= 4; ++vertex)
    for (const uint32_t decision : {0u, 4u, 6u, 7u}) decisions.push_back(vertex * 16 + decision);
  // One sample a pixel: those of a pixel share the shuffle's coarse steps, and a chi-square test takes no such
  // clusters.
  constexpr uint32_t kSide = 448;
  for (const uint32_t seed : {0u, 5u}) {
    std::vector<std::vector<float>> coordinates;
    for (const uint32_t decision : decisions) {
      std::vector<RandomQuestion> questions;
      for (uint32_t y = 0; y < kSide; ++y)
        for (uint32_t x = 0; x < kSide; ++x) questions.push_back({x, y, (11 * x + 29 * y) % 64, decision});
      const std::vector<glm::vec4> points = pathSamplesAt(questions, seed, 6);
      coordinates.push_back(component(points, 0));
      coordinates.push_back(component(points, 1));
    }
    const size_t tests = 2 * coordinates.size() * (coordinates.size() - 1) / 2;
    for (size_t a = 0; a < coordinates.size(); ++a)
      for (size_t b = a + 2 - a % 2; b < coordinates.size(); ++b)
        EXPECT_GE(evenly(coordinates[a], coordinates[b]), sidak(0.01, tests))
            << "seed " << seed << ", decision " << decisions[a / 2] << " coordinate " << a % 2 << " and decision "
            << decisions[b / 2] << " coordinate " << b % 2;
  }
}

}  // namespace
}  // namespace helio::test
