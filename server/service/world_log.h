// A world and its log, kept together: read back when the world is loaded, written before an edit is applied.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "service/failure.h"
#include "service/world_source.h"
#include "store/edit_log.h"
#include "world/world.h"

namespace helio::service {

struct EditAnswer {
  struct Built {
    uint64_t first = 0, count = 0;
  };
  uint64_t seq = 0;
  uint64_t epoch = 0;
  std::vector<Built> built;
  uint64_t destroyed = 0;
  bool replayed = false;
};

struct EditRequest {
  std::string request_id;
  std::optional<uint64_t> expected_seq;
  std::vector<world::Edit> edits;
  /// Not begun after this: who asked has given up.
  std::chrono::system_clock::time_point deadline = std::chrono::system_clock::time_point::max();
};

/// Enters a new world into the log, so that it is there after a restart. Errors: the log's.
Result<void> enterIntoLog(store::EditLog& log, const std::string& world, const Manifest& manifest);

/// Thread-safe after load().
class WorldLog {
 public:
  /// `log` outlives this object. `snapshot_bytes`: see ServerConfig. `on_fatal`: world and log have come apart.
  WorldLog(const std::string& world, store::EditLog& log, uint64_t snapshot_bytes,
           std::function<void(const Error&)> on_fatal);
  /// Waits for a snapshot that is being written.
  ~WorldLog();

  /// Takes the world over and brings it to where its log ends: snapshot, then every record after it. From then on
  /// snapshots are written in the background; the world must live until this object has gone. Errors: the log's, the
  /// scene is not the one that the edits were made in (unsupported).
  Result<std::unique_ptr<world::World>> load(const scene::ScenePtr& scene, const WorldSource& source,
                                             const world::Limits& limits);

  /// Resolves, logs, applies: all or none. Failures: those of resolve, too late, expected_seq, fenced, outcome unknown.
  Outcome<EditAnswer> apply(world::World& world, const EditRequest& request);

  uint64_t epoch() const { return epoch_; }

 private:
  Result<void> checkScene(const scene::Scene& scene, Manifest manifest);
  Result<void> restore(world::World& world);
  Result<uint64_t> catchUp(world::World& world);
  Outcome<std::optional<EditAnswer>> replay(const std::string& request_id) const;
  Failure diverged(const Error& error) const;
  Failure outcomeUnknown(const std::string& request_id) const;
  void grew(uint64_t bytes);
  void writeSnapshots(world::World& world);
  Result<size_t> writeSnapshot(world::World& world);

  const std::string world_;
  store::EditLog& log_;
  const uint64_t snapshot_bytes_;
  const std::function<void(const Error&)> on_fatal_;
  std::atomic<uint64_t> epoch_ = 0;

  std::mutex edit_mutex_;   // what was resolved is logged and applied before anything else is resolved
  bool unsettled_ = false;  ///< an append's answer was lost: the log may be ahead of the world

  std::mutex snapshot_mutex_;  // guards what follows
  std::condition_variable snapshot_due_;
  uint64_t bytes_since_snapshot_ = 0;
  uint64_t last_snapshot_bytes_ = 0;
  bool stopping_ = false;
  std::thread snapshots_;
};

}  // namespace helio::service
