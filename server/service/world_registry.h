// The worlds of this server by name, and how many viewers there may be.
#pragma once

#include <atomic>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "service/hosted_world.h"
#include "service/limits.h"

namespace helio::service {

using WorldPtr = std::shared_ptr<HostedWorld>;

/// A place among the server's viewers; given back when it is destroyed.
using ViewerPlace = std::shared_ptr<void>;

/// Thread-safe.
class WorldRegistry {
 public:
  WorldRegistry(WorldEnvironment environment, const Limits& limits);
  /// Waits for every world's thread.
  ~WorldRegistry();

  using FindSource = std::function<Outcome<WorldSource>(const Manifest&)>;
  /// Before anything else: every world of the log is here again, and being loaded. One that cannot be is here too, with
  /// its error, so that it can be looked at and deleted. Errors: the log's, max_worlds (limit).
  Result<void> restore(const FindSource& find_source);

  /// `name` empty: one is chosen. It is in the log when this returns. Failures: name (form, taken, still being
  /// deleted), max_worlds, draining, the log's.
  Outcome<WorldPtr> create(std::string name, WorldSource source);
  Outcome<WorldPtr> find(const std::string& name) const;
  /// By name, ascending; only names after `after`.
  std::vector<WorldPtr> list(const std::string& after = {}) const;
  /// Ends its viewers. The log has forgotten it when this returns. Failures: unknown world, the log's.
  Outcome<void> remove(const std::string& name);

  struct Repaired {
    WorldPtr world;  ///< being loaded
    store::Repair kept;
  };
  /// Of a world that failed since its log is damaged: what can be read of it, again. Failures: unknown world, one that
  /// is not damaged, more than `accept_loss` sequence numbers would go (nothing is changed then), the log's.
  Outcome<Repaired> repair(const std::string& name, uint64_t accept_loss);

  /// The server counts as started only when this world has been loaded, as those that restore() finds.
  void await(const WorldPtr& world);
  /// All of those have been loaded, or cannot be.
  bool started() const;

  /// Whom views wait for gives way to who is here. `returning`: has a place already, and is let in on it. Failures:
  /// max_viewers, draining.
  Outcome<ViewerPlace> admitViewer(bool returning = false);

  /// Ends every viewer; nothing is created or found any more.
  void drain();

 private:
  Outcome<void> reserve(std::string& name);
  void reap();

  const WorldEnvironment environment_;
  const Limits& limits_;
  mutable std::mutex mutex_;
  std::map<std::string, WorldPtr> worlds_;
  // Names that are being written into the log, or out of it; they are taken until then.
  std::set<std::string> entering_, leaving_;
  std::vector<WorldPtr> dying_;  ///< removed, their threads still at work; their names are taken until then
  bool draining_ = false;
  mutable std::vector<std::weak_ptr<HostedWorld>> awaited_;  ///< the server is not ready before they are
  uint64_t chosen_names_ = 0;
  std::shared_ptr<std::atomic<uint32_t>> viewers_ = std::make_shared<std::atomic<uint32_t>>(0);
};

}  // namespace helio::service
