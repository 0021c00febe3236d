// What `helio-bench stability` found, as a page to look at.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bench/report.h"

namespace helio::bench {

/// One way to one picture.
struct StabilityResult {
  std::string way;
  uint32_t samples = 0;
  uint64_t nonfinite_samples = 0;
  uint32_t broken_texels = 0;
  double mean = 0.0, standard_error = 0.0, energy_error = 0.0, worst_texel = 0.0;
  std::optional<double> error;       ///< against the truth
  std::optional<double> similarity;  ///< to the twin
  std::vector<std::string> broken;   ///< what does not hold
  std::string png;

  bool holds() const { return broken.empty(); }
  /// What grows as things go wrong: the error against truth, or else how unlike the twin, or else the energy gained.
  double badness() const { return error ? *error : similarity ? 1.0 - *similarity : energy_error; }
};

struct StabilityPoint {
  double value = 0.0;  ///< of the case's parameter
  std::optional<double> truth;
  std::vector<StabilityResult> results;
};

struct StabilityCase {
  std::string name, parameter;
  bool variants = false;
  std::vector<StabilityPoint> points;

  bool holds() const;
};

/// A self-contained HTML page: a table, and for every case its pictures and a plot of error against difficulty.
std::string stabilityPage(const Provenance& origin, const std::vector<StabilityCase>& cases);

}  // namespace helio::bench
