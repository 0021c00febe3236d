// The port for operators: health and metrics over plain HTTP. Nothing of worlds or users goes over it.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "base/result.h"

namespace helio::daemon {

/// GET /livez: 200 while the process runs at all, also while a pipeline compiles or a world loads: a supervisor that
/// restarts on it restarts nothing that only takes long. GET /readyz: 200 while new clients are welcome, else 503 with
/// the reason. GET /metrics: Prometheus' text format.
class OpsPort {
 public:
  struct Source {
    std::function<std::string()> not_ready;  ///< empty: ready
    std::function<std::string()> metrics;
  };

  /// `address`: host:port, port 0 picks a free one. Alive, and not ready, from now on. Errors: an address that cannot
  /// be listened on (unavailable).
  static Result<std::unique_ptr<OpsPort>> open(const std::string& address);
  ~OpsPort();

  /// host:port as bound.
  const std::string& address() const;
  /// What is asked from now on. An empty Source: not ready, as at the start.
  void show(Source source);

 private:
  struct Parts;
  explicit OpsPort(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

/// "host:port" taken apart; brackets around an IPv6 address go. None: it is not of this form.
struct HostAndPort {
  std::string host;
  int port = 0;
};
Result<HostAndPort> parseAddress(const std::string& flag, const std::string& address);

}  // namespace helio::daemon
