// One run of a scenario against a server: worlds, clients, the server's own telemetry, and the count of edits.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "load/record.h"
#include "load/scenario.h"

namespace helio::load {

struct ServerSample {
  double t = 0;  ///< seconds since the run's start
  double memory_bytes = 0;
  double ticks_per_second = 0;  ///< of all worlds together
};

struct ClientResult {
  size_t group = 0;  ///< index in the scenario
  std::unique_ptr<Record> record;
};

struct RunResult {
  std::string variant;
  uint32_t round = 1;
  double seconds = 0;
  double warm_up = 0;
  std::string server_version, device;
  std::vector<ClientResult> clients;
  std::vector<ServerSample> server;
  uint64_t lost_edits = 0, doubled_edits = 0;
};

struct Progress {
  double seconds = 0, duration = 0;
  Counts counts;  ///< of all clients
};

/// Everybody who takes part in `variant` (empty: everybody) attaches to `server`. Worlds that it makes are deleted.
/// Errors: the server's, before the clients start; later ones are counted.
Result<RunResult> run(const Scenario& scenario, const std::string& variant, uint32_t round, const std::string& server,
                      const std::function<void(const Progress&)>& progress);

/// The values of a metric with many values, ascending. Group empty: of all clients.
std::vector<double> valuesOf(const Scenario& scenario, const RunResult& run, const std::string& metric,
                             const std::string& group);
/// The value of a metric that is one number. None: nothing was measured.
std::optional<double> numberOf(const Scenario& scenario, const RunResult& run, const std::string& metric,
                               const std::string& group);

}  // namespace helio::load
