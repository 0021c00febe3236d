// What helio-bench accuracy says of pictures and settings, against values that are known.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "bench/accuracy.h"
#include "bench/accuracy_path.h"
#include "render/metrics/flip.h"

namespace helio::bench {
namespace {

constexpr uint32_t kWidth = 64, kHeight = 48;

uint32_t hashed(uint32_t x) {
  x = (x ^ (x >> 16)) * 0x7feb352du;
  x = (x ^ (x >> 15)) * 0x846ca68bu;
  return x ^ (x >> 16);
}

/// Two pictures by the functions of (x, y, channel).
template <typename F, typename G>
double flipOf(const F& reference, const G& test) {
  std::vector<uint8_t> a, b;
  for (uint32_t y = 0; y < kHeight; ++y)
    for (uint32_t x = 0; x < kWidth; ++x)
      for (uint32_t c = 0; c < 4; ++c) {
        a.push_back(c < 3 ? static_cast<uint8_t>(reference(x, y, c)) : uint8_t{255});
        b.push_back(c < 3 ? static_cast<uint8_t>(test(x, y, c)) : uint8_t{255});
      }
  return SeenPicture(a.data(), kWidth, kHeight).difference(SeenPicture(b.data(), kWidth, kHeight));
}

uint32_t gradient(uint32_t x, uint32_t y, uint32_t c) { return c == 0 ? 4 * x : c == 1 ? 5 * y : 255 - 2 * (x + y); }

// The expected values are what the authors' own implementation, FLIP.h of NVlabs/flip at commit 1eb247ca, says of the
// same pictures.
TEST(Flip, SaysWhatTheAuthorsSay) {
  EXPECT_EQ(flipOf(gradient, gradient), 0.0);
  EXPECT_NEAR(flipOf([](auto, auto, auto) { return 0u; }, [](auto, auto, auto) { return 255u; }), 0.967388, 2e-5);
  EXPECT_NEAR(flipOf(gradient,
                     [](uint32_t x, uint32_t y, uint32_t c) {
                       return std::min(255u, gradient(x, y, c) + hashed(3 * (y * kWidth + x) + c) % 41);
                     }),
              0.344641, 2e-6);
  EXPECT_NEAR(flipOf(gradient,
                     [](uint32_t x, uint32_t y, uint32_t c) {
                       const uint32_t value = gradient(std::min(x + 1, kWidth - 1), y, c);
                       return c == 0 && (x / 8 + y / 8) % 2 ? 255 - value : value;
                     }),
              0.430261, 2e-6);
  EXPECT_NEAR(flipOf(gradient, [](uint32_t x, uint32_t y, uint32_t c) { return x == 32 ? 0u : gradient(x, y, c); }),
              0.033626, 2e-6);
}

TEST(Ssim, OfFlatPicturesIsKnownInClosedForm) {
  const std::vector<double> a(size_t{kWidth} * kHeight, 0.3), b(a.size(), 0.6);
  EXPECT_NEAR(ssim(a, b, kWidth, kHeight), (2 * 0.3 * 0.6 + 1e-4) / (0.09 + 0.36 + 1e-4), 1e-12);
  EXPECT_EQ(ssim(a, a, kWidth, kHeight), 1.0);
}

TEST(Ssim, IsTheMeanOverWindowsOfTheDefinition) {
  // [Wang et al. 2004, eq. 13], window by window, in two dimensions at once.
  std::mt19937 random(3);
  std::uniform_real_distribution<double> any(0.0, 1.0);
  constexpr int kSide = 14;
  std::vector<double> a(kSide * kSide), b(a.size());
  for (size_t i = 0; i < a.size(); ++i) a[i] = any(random), b[i] = 0.5 * a[i] + 0.5 * any(random);
  double sum = 0.0;
  for (int cy = 0; cy < kSide; ++cy)
    for (int cx = 0; cx < kSide; ++cx) {
      double n = 0, ma = 0, mb = 0, aa = 0, bb = 0, ab = 0;
      for (int y = std::max(0, cy - 5); y <= std::min(kSide - 1, cy + 5); ++y)
        for (int x = std::max(0, cx - 5); x <= std::min(kSide - 1, cx + 5); ++x) {
          const double w = std::exp(-((x - cx) * (x - cx) + (y - cy) * (y - cy)) / 4.5);
          const double p = a[static_cast<size_t>(y * kSide + x)], q = b[static_cast<size_t>(y * kSide + x)];
          n += w, ma += w * p, mb += w * q, aa += w * p * p, bb += w * q * q, ab += w * p * q;
        }
      ma /= n, mb /= n;
      const double va = aa / n - ma * ma, vb = bb / n - mb * mb, cov = ab / n - ma * mb;
      sum += (2 * ma * mb + 1e-4) * (2 * cov + 9e-4) / ((ma * ma + mb * mb + 1e-4) * (va + vb + 9e-4));
    }
  EXPECT_NEAR(ssim(a, b, kSide, kSide), sum / (kSide * kSide), 1e-10);
}

TEST(Accuracy, TellsBiasFromVariance) {
  std::mt19937 random(7);
  std::normal_distribution<float> noise(0.0f, 0.2f);
  const Image truth{40, 40, std::vector<float>(4800, 2.0f)};
  std::vector<Image> pictures(64, truth);
  for (Image& picture : pictures)
    for (float& value : picture.rgb) value += 0.1f + noise(random);
  const Decomposition d = decompose(pictures, truth);
  const double unit = 4.0 + 0.01;
  EXPECT_NEAR(d.bias, 0.01 / unit, 1e-4);
  EXPECT_NEAR(d.variance, 0.04 / unit, 2e-4);
  EXPECT_NEAR(d.total, d.bias + d.variance, 1e-12);
  double mean = 0.0;
  for (const Image& picture : pictures) mean += relativeMse(picture, truth) / 64.0;
  EXPECT_NEAR(d.total, mean, 1e-9);
}

AccuracyPoint point(const std::string& name, double ms, double error) {
  AccuracyPoint p{"bounces", name};
  p.frame_ms = {ms, ms};
  p.error = {error, 0.25 * error, 0.75 * error};
  p.recovery = {2 * error, error};
  p.ssim_along = {0.5, 0.75};
  return p;
}

TEST(Accuracy, TheFrontHasWhatNothingBeats) {
  EXPECT_EQ(paretoFront(
                {point("a", 3, 0.1), point("b", 1, 0.5), point("c", 2, 0.6), point("d", 4, 0.1), point("e", 5, 0.05)}),
            (std::vector<size_t>{1, 0, 4}));
}

TEST(Accuracy, SaysInWordsWhatAStepCosts) {
  EXPECT_EQ(sentence({point("1", 10, 0.5), point("3", 11.9, 0.345)}),
            "From 1 to 3: costs 1.9 ms (19 % of a frame) and takes 31 % of the error. Of what 3 leaves, 25 % is bias.");
  EXPECT_EQ(sentence({point("1", 10, 0.5), point("3", 9, 0.6)}),
            "From 1 to 3: saves 1 ms (10 % of a frame) and adds 20 % of the error. Of what 3 leaves, 25 % is bias.");
}

TEST(Accuracy, EverySettingIsOneThatViewsTake) {
  for (const std::string& axis : accuracyAxes()) {
    const auto settings = settingsOf(axis, baseSettings(64, 64));
    ASSERT_TRUE(settings) << axis;
    EXPECT_GE(settings->size(), 2u) << axis;
    for (const AccuracySetting& setting : *settings)
      EXPECT_TRUE(render::check(setting.view)) << axis << " " << setting.name;
  }
  const auto none = settingsOf("wishes", baseSettings(64, 64));
  ASSERT_FALSE(none);
  EXPECT_NE(none.error().message.find("there is no axis \"wishes\": give all, spp, bounces"), std::string::npos);
}

TEST(Accuracy, ThePageNeedsNoOtherFile) {
  AccuracyReport report;
  report.scene = "a <scene>";
  report.points = {point("1", 10, 0.5), point("3", 11.9, 0.345)};
  const std::string page = toHtml(report);
  EXPECT_EQ(page.find("<scene>"), std::string::npos);
  EXPECT_NE(page.find("takes 31 % of the error"), std::string::npos);
  EXPECT_EQ(page.find("http"), std::string::npos);
  EXPECT_EQ(page.find("src="), std::string::npos);
  const std::string csv = toCsv(report);
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 3);
  EXPECT_EQ(toJson(report)["points"][1]["relmse"], 0.345);
}

TEST(Accuracy, ChangeAlongTheMotionIsOfWhatDoesNotMove) {
  // A pattern that moves by 3 pixels to the right and 2 down, and another by a half: linear, so that reading between
  // pixels is exact.
  const auto picture = [](float x0, float y0) {
    std::vector<uint8_t> pixels;
    for (uint32_t y = 0; y < kHeight; ++y)
      for (uint32_t x = 0; x < kWidth; ++x) {
        const auto value = static_cast<uint8_t>(
            std::lround(2.0f * (static_cast<float>(x) - x0) + 1.0f * (static_cast<float>(y) - y0) + 20.0f));
        pixels.insert(pixels.end(), {value, value, value, 255});
      }
    return pixels;
  };
  const auto field = [](float x, float y) { return MotionField(size_t{kWidth} * kHeight, glm::vec2(x, y)); };
  EXPECT_NEAR(meanChange(picture(0, 0), picture(3, 2), field(-3, -2), kWidth, kHeight), 0.0, 1e-9);
  EXPECT_NEAR(meanChange(picture(0, 0), picture(0.5f, 0), field(-0.5f, 0), kWidth, kHeight), 0.0, 1e-6);
  EXPECT_NEAR(meanChange(picture(0, 0), picture(3, 2), field(0, 0), kWidth, kHeight), 8.0 / 255.0, 1e-6);
  EXPECT_EQ(meanChange(picture(0, 0), picture(3, 2), field(1000, 0), kWidth, kHeight),
            0.0);  // nothing was in the picture
}

TEST(Accuracy, AFlightEndsWhereItIsAskedFor) {
  const scene::Camera end{{1, 2, 3}, {0, 0, -1}, {0, 1, 0}, 0.8f};
  EXPECT_EQ(cameraBefore(end, MotionKind::fly, 0).position, end.position);
  EXPECT_NEAR(glm::distance(cameraBefore(end, MotionKind::fly, 8).position, end.position), 0.16f, 1e-5f);
  EXPECT_EQ(cameraBefore(end, MotionKind::jump, 8).position, end.position);
  EXPECT_GT(glm::distance(cameraElsewhere(end).position, end.position), 25.0f);  // what the renderer calls a jump
}

}  // namespace
}  // namespace helio::bench
