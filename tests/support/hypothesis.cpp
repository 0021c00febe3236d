#include "support/hypothesis.h"

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <numeric>

namespace helio::test {
namespace {

constexpr double kLeastExpected = 5.0;
constexpr double kRounding = 1e-5;

struct Estimate {
  double mean = 0.0;
  double variance = 0.0;  // of the mean
};

Estimate estimate(std::span<const double> values) {
  const auto n = static_cast<double>(values.size());
  Estimate e;
  for (double v : values) e.mean += v / n;
  for (double v : values) e.variance += (v - e.mean) * (v - e.mean) / (n * (n - 1.0));
  return e;
}

/// Two-sided p-value of a difference whose variance was estimated with so many degrees of freedom.
double twoSided(double difference, double variance, double degrees, double scale) {
  const double t = std::abs(difference) / std::sqrt(variance + std::pow(kRounding * scale, 2.0));
  if (!(t > 0.0)) return std::isnan(difference) ? 0.0 : 1.0;
  if (!std::isfinite(t)) return 0.0;
  return 2.0 * boost::math::cdf(boost::math::complement(boost::math::students_t(degrees), t));
}

std::vector<double> texel(const Batches& batches, size_t i) {
  std::vector<double> values;
  for (const std::vector<double>& batch : batches) values.push_back(batch[i]);
  return values;
}

}  // namespace

double sidak(double alpha, size_t tests) { return -std::expm1(std::log1p(-alpha) / static_cast<double>(tests)); }

ChiSquare chiSquare(std::span<const double> observed, std::span<const double> expected) {
  std::vector<size_t> order(expected.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::sort(order.begin(), order.end(), [&](size_t a, size_t b) { return expected[a] < expected[b]; });

  ChiSquare test;
  size_t cells = 0;
  double pooled_observed = 0.0, pooled_expected = 0.0;
  for (const size_t i : order) {
    pooled_observed += observed[i];
    pooled_expected += expected[i];
    if (pooled_expected < kLeastExpected) continue;
    test.statistic += std::pow(pooled_observed - pooled_expected, 2.0) / pooled_expected;
    pooled_observed = pooled_expected = 0.0;
    ++cells;
  }
  test.degrees = cells > 0 ? cells - 1 : 0;
  if (!std::isfinite(test.statistic)) test.p = 0.0;
  else if (test.degrees > 0)
    test.p = boost::math::cdf(
        boost::math::complement(boost::math::chi_squared(static_cast<double>(test.degrees)), test.statistic));
  return test;
}

std::vector<double> means(const Batches& batches) {
  std::vector<double> result(batches.at(0).size());
  for (const std::vector<double>& batch : batches)
    for (size_t i = 0; i < result.size(); ++i) result[i] += batch[i] / static_cast<double>(batches.size());
  return result;
}

std::vector<double> welch(const Batches& a, const Batches& b) {
  std::vector<double> p(a.at(0).size());
  const double degrees_a = static_cast<double>(a.size()) - 1.0, degrees_b = static_cast<double>(b.size()) - 1.0;
  for (size_t i = 0; i < p.size(); ++i) {
    const Estimate ea = estimate(texel(a, i)), eb = estimate(texel(b, i));
    const double variance = ea.variance + eb.variance;
    // Degrees of freedom by Welch and Satterthwaite.
    const double fourth = ea.variance * ea.variance / degrees_a + eb.variance * eb.variance / degrees_b;
    const double degrees = fourth > 0.0 ? variance * variance / fourth : degrees_a + degrees_b;
    p[i] = twoSided(ea.mean - eb.mean, variance, degrees, std::max(std::abs(ea.mean), std::abs(eb.mean)));
  }
  return p;
}

std::vector<double> paired(const Batches& a, const Batches& b) {
  std::vector<double> p(a.at(0).size());
  for (size_t i = 0; i < p.size(); ++i) {
    std::vector<double> differences = texel(a, i);
    const double scale = std::abs(estimate(differences).mean);
    for (size_t k = 0; k < differences.size(); ++k) differences[k] -= b[k][i];
    const Estimate e = estimate(differences);
    p[i] = twoSided(e.mean, e.variance, static_cast<double>(a.size()) - 1.0, scale);
  }
  return p;
}

double passing(std::span<const double> p, double alpha) {
  const double significance = sidak(alpha, p.size());
  const auto passed = std::count_if(p.begin(), p.end(), [&](double v) { return v >= significance; });
  return static_cast<double>(passed) / static_cast<double>(p.size());
}

Batches blocks(const Batches& batches, uint32_t width, uint32_t block) {
  const auto height = static_cast<uint32_t>(batches.at(0).size() / width);
  const uint32_t columns = (width + block - 1) / block, rows = (height + block - 1) / block;
  Batches result;
  for (const std::vector<double>& batch : batches) {
    std::vector<double> sum(size_t{columns} * rows), count(sum.size());
    for (uint32_t y = 0; y < height; ++y)
      for (uint32_t x = 0; x < width; ++x) {
        const size_t to = size_t{y / block} * columns + x / block;
        sum[to] += batch[size_t{y} * width + x];
        count[to] += 1.0;
      }
    for (size_t i = 0; i < sum.size(); ++i) sum[i] /= count[i];
    result.push_back(std::move(sum));
  }
  return result;
}

}  // namespace helio::test
