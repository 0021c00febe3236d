// What is said about a series of measurements.
#pragma once

#include <vector>

#include "base/median.h"

namespace helio::bench {

using helio::median;

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
