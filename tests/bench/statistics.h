// What is said about a series of measurements.
#pragma once

#include <vector>

namespace helio::bench {

/// The middle value; of an even number of values the mean of the two in the middle. `values` must not be empty.
double median(std::vector<double> values);

/// Nearest rank: the smallest value that at least `percent` percent of all values do not exceed, so always a value that
/// was measured (no interpolation). `percent` in [1, 100]; `values` must not be empty.
double percentile(std::vector<double> values, unsigned percent);

struct Summary {
  double median = 0.0;
  double p95 = 0.0;  ///< 95th percentile, nearest rank: of fewer than 20 values the largest
};

/// Zeros where nothing was measured.
Summary summarise(const std::vector<double>& values);

}  // namespace helio::bench
