#include "bench/statistics.h"

#include <algorithm>
#include <cstddef>

namespace helio::bench {

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 == 1) return *middle;
  return 0.5 * (*middle + *std::max_element(values.begin(), middle));
}

double percentile(std::vector<double> values, unsigned percent) {
  const size_t rank = (values.size() * percent + 99) / 100;  // in integers: 0.95 * 20 is not quite 19
  const auto ranked = values.begin() + static_cast<std::ptrdiff_t>(rank - 1);
  std::nth_element(values.begin(), ranked, values.end());
  return *ranked;
}

Summary summarise(const std::vector<double>& values) {
  if (values.empty()) return {};
  return {median(values), percentile(values, 95)};
}

}  // namespace helio::bench
