// Errors between pictures, against sums made by hand.
#include "bench/image.h"

#include <gtest/gtest.h>

namespace helio::bench {
namespace {

/// A row of grey pixels.
Image grey(std::vector<float> values) {
  Image image{static_cast<uint32_t>(values.size()), 1, {}};
  for (const float v : values) image.rgb.insert(image.rgb.end(), 3, v);
  return image;
}

TEST(PictureError, IsRelativeToTheTruthAndAbsoluteInTheDark) {
  // (0.5^2 / 1.01 + 0.1^2 / 0.01) / 2
  EXPECT_NEAR(relativeMse(grey({1.5f, 0.1f}), grey({1.0f, 0.0f})), 0.5 * (0.25 / 1.01 + 1.0), 1e-6);
}

TEST(PictureError, TheMedianDoesNotSeeAnOutlier) {
  const Image truth = grey({1.0f, 1.0f, 1.0f, 1.0f, 1.0f});
  EXPECT_NEAR(medianRelativeSquare(grey({1.1f, 1.1f, 900.0f, 1.1f, 1.1f}), truth), 0.01 / 1.01, 1e-6);
}

TEST(PictureError, TheWorstPixelsHoldTheirShare) {
  const Image truth = grey({1.0f, 1.0f, 1.0f, 1.0f});
  const Image image = grey({1.1f, 1.3f, 1.1f, 1.1f});  // squares 1 : 9 : 1 : 1
  EXPECT_NEAR(shareOfWorst(image, truth, 0.25), 0.75, 1e-5);
  EXPECT_NEAR(shareOfWorst(image, truth, 0.5), 10.0 / 12.0, 1e-5);
  EXPECT_NEAR(shareOfWorst(image, truth, 1.0), 1.0, 1e-12);
}

}  // namespace
}  // namespace helio::bench
