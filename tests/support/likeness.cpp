#include "support/likeness.h"

namespace helio::test {
namespace {

constexpr uint32_t kWindow = 8;
constexpr double kC1 = 0.01 * 255 * 0.01 * 255, kC2 = 0.03 * 255 * 0.03 * 255;

/// Rec. 601 luma, [0, 255].
double luma(const render::Pixels& picture, uint32_t x, uint32_t y) {
  const uint8_t* p = picture.rgbx + 4 * (size_t{y} * picture.width + x);
  return 0.299 * p[0] + 0.587 * p[1] + 0.114 * p[2];
}

double windowSimilarity(const render::Pixels& a, const render::Pixels& b, uint32_t left, uint32_t top) {
  constexpr double n = kWindow * kWindow;
  double sum_a = 0, sum_b = 0, squares_a = 0, squares_b = 0, products = 0;
  for (uint32_t y = top; y < top + kWindow; ++y)
    for (uint32_t x = left; x < left + kWindow; ++x) {
      const double p = luma(a, x, y), q = luma(b, x, y);
      sum_a += p, sum_b += q, squares_a += p * p, squares_b += q * q, products += p * q;
    }
  const double mean_a = sum_a / n, mean_b = sum_b / n;
  const double variance_a = squares_a / n - mean_a * mean_a, variance_b = squares_b / n - mean_b * mean_b,
               covariance = products / n - mean_a * mean_b;
  return (2 * mean_a * mean_b + kC1) * (2 * covariance + kC2) /
         ((mean_a * mean_a + mean_b * mean_b + kC1) * (variance_a + variance_b + kC2));
}

}  // namespace

double structuralSimilarity(const render::Pixels& a, const render::Pixels& b) {
  double sum = 0.0;
  uint64_t windows = 0;
  for (uint32_t top = 0; top + kWindow <= a.height; ++top)
    for (uint32_t left = 0; left + kWindow <= a.width; ++left, ++windows) sum += windowSimilarity(a, b, left, top);
  return sum / static_cast<double>(windows);
}

}  // namespace helio::test
