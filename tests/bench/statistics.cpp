#include "bench/statistics.h"

#include <algorithm>
#include <cstddef>

namespace helio::bench {

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
