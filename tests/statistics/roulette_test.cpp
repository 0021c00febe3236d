// Unbiasedness: Russian roulette on against off, texel by texel [correctness: z-tests]. In this renderer one switch
// covers the roulette of paths, of faint shadow rays and of lamps that add little.
#include <gtest/gtest.h>

#include <algorithm>

#include "support/batches.h"
#include "support/scenes.h"

namespace helio::test {
namespace {

constexpr double kAlpha = 0.01;
constexpr double kTexelsThatPass = 0.9975;
constexpr uint32_t kBatches = 16;
constexpr uint32_t kWidth = 64;

/// Both use the same random numbers where roulette leaves them alone. Blocks are therefore compared batch by batch, in
/// pairs; in a single texel too few paths differ for the spread of the pairs to be known.
void expectRouletteUnbiased(const scene::ScenePtr& scene, const scene::Camera& camera) {
  Stage stage(scene);
  render::ViewSettings settings = referenceSettings(kWidth, 36);
  settings.samples = 32;
  settings.bounces = 4;
  settings.roulette = false;
  const Batches without = renderBatches(stage, camera, settings, kBatches);
  settings.roulette = true;
  const Batches with = renderBatches(stage, camera, settings, kBatches);
  ASSERT_NE(with, without) << "roulette did nothing";

  const std::vector<double> texels = welch(luminance(with), luminance(without));
  EXPECT_GE(passing(texels, kAlpha), kTexelsThatPass);
  // What hides in the noise of a texel shows over blocks, and over the whole picture.
  for (size_t c = 0; c < 3; ++c)
    for (const uint32_t block : {8u, kWidth}) {
      const std::vector<double> p =
          paired(blocks(channel(with, c), kWidth, block), blocks(channel(without, c), kWidth, block));
      EXPECT_GE(*std::min_element(p.begin(), p.end()), sidak(kAlpha, 3 * p.size()))
          << "channel " << c << ", blocks of " << block;
    }
}

const scene::Camera kIntoTheRoom = lookAt({0, 2, 6.5f}, {0, 1.8f, 0});

TEST(Roulette, IsUnbiasedInTheStillLife) { expectRouletteUnbiased(stillLife(), lookAt({0, 2, 5}, {0, 0.5f, 0})); }

TEST(Roulette, IsUnbiasedAmongLamps) { expectRouletteUnbiased(lampRoom(), kIntoTheRoom); }

// Of lamps so faint that nearly every shadow ray, and whether a lamp is sampled at all, is left to chance.
TEST(Roulette, IsUnbiasedAmongFaintLamps) { expectRouletteUnbiased(lampRoom(0.01f), kIntoTheRoom); }

}  // namespace
}  // namespace helio::test
