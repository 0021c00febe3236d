#include "load/metrics.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace helio::load {
namespace {

template <typename List>
bool has(const List& list, const std::string& name) {
  return std::find(list.begin(), list.end(), name) != list.end();
}

}  // namespace

std::optional<Series> seriesOf(const std::string& name) {
  const auto found = std::find(kSeriesNames.begin(), kSeriesNames.end(), name);
  if (found == kSeriesNames.end()) return std::nullopt;
  return static_cast<Series>(found - kSeriesNames.begin());
}

bool hasStatistic(const std::string& metric) { return seriesOf(metric) || has(kSpreadNames, metric); }

bool knowsGroups(const std::string& metric) {
  return metric != "server_memory_mib" && (hasStatistic(metric) || has(kGroupCountNames, metric));
}

bool isMetric(const std::string& name) {
  return hasStatistic(name) || has(kGroupCountNames, name) || has(kRunCountNames, name);
}

std::optional<double> statistic(const std::vector<double>& sorted, const std::string& name) {
  if (sorted.empty()) return std::nullopt;
  if (name == "mean") return std::accumulate(sorted.begin(), sorted.end(), 0.0) / double(sorted.size());
  const double percent = name == "min" ? 0 : name == "max" ? 100 : std::stod(name.substr(1));
  // The epsilon keeps 99 % of 100 values the 99th, whatever 0.99 is in binary.
  const double rank = std::ceil(percent / 100 * double(sorted.size()) - 1e-9);
  return sorted[static_cast<size_t>(std::max(rank, 1.0)) - 1];
}

}  // namespace helio::load
