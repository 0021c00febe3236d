// A world on this server: its loading, its edits, and the thread that ticks it while somebody wants frames.
#pragma once

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "service/view_sink.h"
#include "service/world_log.h"
#include "service/world_source.h"
#include "world/world.h"

namespace helio::service {

/// What all worlds of a server share. Outlives them.
struct WorldEnvironment {
  render::Renderer* renderer = nullptr;
  store::EditLog* log = nullptr;
  world::Limits limits;
  uint64_t snapshot_bytes = 0;                 ///< see ServerConfig
  std::function<void(const Error&)> on_fatal;  ///< the device is lost or an invariant broke
};

/// Thread-safe.
class HostedWorld {
 public:
  enum class State { loading, ready, failed };

  /// Starts to load.
  HostedWorld(std::string name, WorldSource source, const WorldEnvironment& environment);
  /// After join().
  ~HostedWorld();

  const std::string& name() const { return name_; }
  const WorldSource& source() const { return source_; }
  State state() const;
  std::string error() const;  ///< why it failed
  uint64_t epoch() const { return log_.epoch(); }

  /// The world's content. Failures: loading (retry), failed, deleted.
  Outcome<const world::World*> content() const;
  Outcome<world::World*> content();

  /// Resolves, logs, applies: all or none. Failures: those of resolve, expected_seq, fenced, outcome unknown.
  Outcome<EditAnswer> apply(const EditRequest& request, Clock::time_point arrived);

  /// Renders for `sink` from the next tick on. Failures as content().
  Outcome<void> attach(std::shared_ptr<ViewSink> sink);
  /// Frees its view as soon as the tick in progress is over. Nothing is called on it afterwards, but end().
  void detach(const ViewSink* sink);
  /// A sink's wish has changed.
  void wake();

  /// Ends every sink with `why`, now. The thread ends after the tick or the loading in progress.
  void stop(const Failure& why);
  /// The thread has ended: join() takes no time.
  bool stopped() const;
  /// After stop(), from any thread but the world's own.
  void join();

  uint32_t viewers() const;
  std::vector<ViewerStatus> viewerStatus() const;
  telemetry::WorldCounters counters() const;
  telemetry::EditLatency& editLatency() { return edit_latency_; }

 private:
  struct View {
    std::shared_ptr<ViewSink> sink;
    std::optional<render::ViewHandle> handle;  ///< none until the tick thread has made it
  };
  using Views = std::vector<std::shared_ptr<View>>;

  void run();
  Result<void> load();
  void tickUntilStopped();
  void admitAndRelease();
  Views waitForDemand();
  void tick(const Views& wanted);
  Result<void> render(const world::ChangeSet& changes, const Views& wanted);
  void renderEach(const world::ChangeSet& changes, const Views& wanted);
  void endAll(const Failure& why);

  const std::string name_;
  const WorldSource source_;
  const WorldEnvironment& environment_;

  mutable std::mutex mutex_;
  std::condition_variable wake_;
  State state_ = State::loading;
  Error error_;  ///< why it failed
  std::optional<Failure> stop_reason_;
  bool stopped_ = false;
  bool woken_ = false;
  Views views_;    ///< attached sinks
  Views leaving_;  ///< detached, their views not freed yet
  telemetry::WorldCounters counters_;

  std::unique_ptr<world::World> content_;       // written before state_ becomes ready
  WorldLog log_;                                // goes before content_
  render::WorldHandle handle_ = 0;              // tick thread only
  Clock::time_point last_tick_{};               // tick thread only
  std::optional<world::ChangeSet> unrendered_;  // tick thread only: changes of ticks that failed

  telemetry::EditLatency edit_latency_;
  std::thread thread_;  // last: everything else is there when it starts
};

}  // namespace helio::service
