// Whether a scenario's objectives are met, and how far the figures are from an earlier run's.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "load/run.h"

namespace helio::load {

/// Keys stay in the order in which they are written.
using Json = nlohmann::ordered_json;

struct Judged {
  std::string name;
  std::optional<double> value;  ///< none: nothing was measured, which meets no objective
  double limit = 0;
  bool at_most = true;
  bool met = false;
  std::string note;  ///< what the value is made of, where that is not plain
};

/// Of several runs the worst counts. With `against` the medians over the runs of two variants are compared, and how far
/// the runs of the second are apart is allowed on top of the limit.
std::vector<Judged> judge(const Scenario& scenario, const std::vector<RunResult>& runs);

/// What --baseline adds: p50 and p99 of every series that both have.
struct Change {
  std::string group, series, statistic;
  double before = 0, now = 0;
  double percent() const { return before > 0 ? 100 * (now / before - 1) : 0; }
};
/// `baseline` and `report` are documents of helio-load. Errors (invalid): the baseline is none, or of another scenario.
Result<std::vector<Change>> compare(const Json& baseline, const Json& report);

}  // namespace helio::load
