// What a load test leaves: a JSON document, a JUnit file, and a page. tests/load/README.md documents the first.
#pragma once

#include <string>
#include <vector>

#include "load/verdict.h"

namespace helio::load {

struct Provenance {
  std::string command, date;  ///< the command line, and the start, UTC, ISO 8601
};

/// schema heliograph.load/1.
Json reportOf(const Scenario& scenario, const std::vector<RunResult>& runs, const std::vector<Judged>& judged,
              const Provenance& provenance);
void append(Json& report, const std::vector<Change>& changes);

/// One test case an objective.
std::string junitOf(const Json& report);
/// A page that needs no other file.
std::string pageOf(const Json& report);
/// For people at a terminal.
std::string textOf(const Json& report);

}  // namespace helio::load
