// The tables that light sampling draws from: what they return with which probability.
#include "effects/emitters.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "effects/light_grid.h"
#include "support/scenes.h"

namespace helio::effects {
namespace {

/// Probability with which an alias table returns each entry.
std::vector<double> probabilities(const AliasTable& table) {
  const size_t n = table.keep.size();
  std::vector<double> p(n);
  for (size_t i = 0; i < n; ++i) {
    p[i] += table.keep[i] / static_cast<double>(n);
    p[table.alias[i]] += (1.0 - table.keep[i]) / static_cast<double>(n);
  }
  return p;
}

TEST(AliasTable, ReturnsEachEntryInProportionToItsWeight) {
  std::mt19937 random(7);
  for (const size_t n : {size_t{1}, size_t{2}, size_t{13}, size_t{1000}}) {
    std::vector<float> weights(n);
    double sum = 0.0;
    for (float& w : weights) sum += w = std::pow(std::uniform_real_distribution<float>(0.0f, 1.0f)(random), 8.0f);
    if (n > 2) sum -= weights[1], weights[1] = 0.0f;  // dark entries are never taken
    const std::vector<double> p = probabilities(makeAliasTable(weights));
    for (size_t i = 0; i < n; ++i) EXPECT_NEAR(p[i], weights[i] / sum, 1e-6) << i << " of " << n;
  }
}

TEST(Emitters, TrianglesShareTheirMeshByPower) {
  test::SceneBuilder b;
  const uint32_t dark = b.material(test::lambert(glm::vec3(0.5f)));
  const uint32_t lamp = b.material(test::lambert(glm::vec3(0.0f), glm::vec3(2.0f)));
  b.prefab("dark", test::cube(), dark);
  b.prefab("lamp", test::quad(3.0f), lamp);
  const EmitterTriangles emitters = collectEmitters(*b.build());
  EXPECT_EQ(emitters.meshes[0].count, 0u);
  ASSERT_EQ(emitters.meshes[1].count, 2u);
  EXPECT_FLOAT_EQ(emitters.meshes[1].power, 9.0f * 2.0f);
  EXPECT_FLOAT_EQ(emitters.triangles[0].pmf, 0.5f);
  // Twice as large in each direction: four times the power.
  EXPECT_NEAR(emitterWeight(18.0f, test::at({5, 0, 0}, 2.0f)), 72.0f, 1e-3f);
}

TEST(LightGrid, ListsTheLightsThatMatter) {
  std::mt19937 random(11);
  std::uniform_real_distribution<float> place(-300.0f, 300.0f);
  std::vector<PlacedLight> lights;
  for (uint32_t i = 0; i < 500; ++i)
    lights.push_back({i, {place(random), 5.0f, place(random)}, 1.0f + static_cast<float>(i % 3)});
  const LightGrid grid = makeLightGrid(lights);
  ASSERT_EQ(grid.cells.size(), size_t{grid.size.x} * grid.size.y);
  for (const PlacedLight& light : lights) {
    const glm::vec2 cell = glm::floor((glm::vec2(light.centre.x, light.centre.z) - grid.origin) * grid.cells_per_metre);
    ASSERT_GE(cell.x, 0.0f);
    ASSERT_LT(cell.x, static_cast<float>(grid.size.x));
    ASSERT_LT(cell.y, static_cast<float>(grid.size.y));
    const shared::LightCell& c = grid.cells[static_cast<size_t>(cell.y) * grid.size.x + static_cast<size_t>(cell.x)];
    ASSERT_GT(c.count, 0u);
    EXPECT_FLOAT_EQ(c.cdf[c.count - 1], 1.0f);
    for (uint32_t i = 1; i < c.count; ++i) EXPECT_GT(c.cdf[i], c.cdf[i - 1]);
    // A light in its own cell is left out only for kLightsPerCell others at least as near or strong.
    EXPECT_TRUE(c.count == shared::kLightsPerCell ||
                std::find(c.slots, c.slots + c.count, light.slot) != c.slots + c.count);
  }
  EXPECT_TRUE(makeLightGrid({}).cells.empty());
}

TEST(LightGrid, FarApartLightsDoNotMakeAnEndlessGrid) {
  const std::vector<PlacedLight> lights{{0, {-90000.0f, 0.0f, -90000.0f}, 1.0f}, {1, {90000.0f, 0.0f, 90000.0f}, 1.0f}};
  const LightGrid grid = makeLightGrid(lights);
  EXPECT_LE(grid.cells.size(), 1'100'000u);
}

}  // namespace
}  // namespace helio::effects
