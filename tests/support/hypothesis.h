// Tests of hypotheses: how likely is what was seen, if the renderer is right?
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace helio::test {

/// Significance of each of `tests` independent tests that keeps the chance of any false alarm at `alpha` [Sidak 1967].
double sidak(double alpha, size_t tests);

struct ChiSquare {
  double statistic = 0.0;
  size_t degrees = 0;  ///< of freedom: cells after pooling, less one
  double p = 1.0;      ///< chance of a statistic at least as large
};
/// Pearson's test of counts against expected counts, cells below 5 expected pooled [Mitsuba 3, chi2.py]. Both sums
/// should agree: what is in no cell, such as absorbed samples, is a cell of its own.
ChiSquare chiSquare(std::span<const double> observed, std::span<const double> expected);

/// A quantity of many texels, measured several times independently: `batches[k][i]` is the mean of texel i in batch k.
using Batches = std::vector<std::vector<double>>;

/// Mean over the batches, by texel.
std::vector<double> means(const Batches& batches);
/// Two-sided p-values, by texel, of "a and b have the same mean": Welch's t-test, variances estimated from the batches.
/// Differences of 1e-5 of the value are rounding, not evidence.
std::vector<double> welch(const Batches& a, const Batches& b);
/// As welch(), where batch k of a and of b used the same random numbers: Student's t-test of the differences.
std::vector<double> paired(const Batches& a, const Batches& b);

/// Share of `p` that is above the significance of `alpha` for so many tests.
double passing(std::span<const double> p, double alpha);

/// Means over blocks of `block` x `block` texels of pictures of `width` texels a row (partial blocks at the end
/// included).
Batches blocks(const Batches& batches, uint32_t width, uint32_t block);

}  // namespace helio::test
