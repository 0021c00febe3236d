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

#include "service/edit_rate.h"
#include "service/view_sink.h"
#include "service/world_log.h"
#include "service/world_source.h"
#include "telemetry/metrics.h"
#include "world/world.h"

namespace helio::service {

/// What all worlds of a server share. Outlives them.
struct WorldEnvironment {
  render::Renderer* renderer = nullptr;
  store::EditLog* log = nullptr;
  world::Limits limits;
  uint64_t snapshot_bytes = 0;                 ///< see ServerConfig
  std::function<void(const Error&)> on_fatal;  ///< the device is lost or an invariant broke
  telemetry::Metrics* metrics = nullptr;
  uint32_t max_edits_per_second = 0;  ///< see Limits
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

  /// Renders for `sink` from the next tick on. With the `key` of a view whose sink is attached (it is ended:
  /// superseded) or was detached lately, that view's history goes on; true then. Failures as content().
  Outcome<bool> attach(std::shared_ptr<ViewSink> sink, const std::string& key = {});
  /// Frees its view as soon as the tick in progress is over. Nothing is called on it afterwards, but end(). With `keep`
  /// above zero a view with a key waits so long to be attached again, and holds on to `place` so long.
  void detach(const ViewSink* sink, std::chrono::seconds keep = {}, std::shared_ptr<void> place = {});
  /// attach() would go on with a view.
  bool knows(const std::string& key) const;
  /// The view of `key` is not waited for any more.
  void forget(const std::string& key);
  /// Views that wait are freed; how many there were. Room for who is here is worth more than for who may come back.
  size_t forgetWaiting();
  /// About once a second: sinks are tended, views that waited in vain are freed.
  void tend(Clock::time_point now);
  /// A sink's wish has changed.
  void wake();

  /// The next picture of the viewer with this id is captured. False: there is no such viewer.
  bool capture(uint64_t viewer, Capture capture);
  /// The right to render beside the ticks; given back when it is destroyed. None: somebody else has it.
  std::shared_ptr<void> admitAside();
  /// Returns when no tick is due for `needed`; at `until` even so, or when the world stops.
  void awaitIdle(Clock::duration needed, Clock::time_point until);

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
    std::string key;                           ///< empty: nobody can come back to it
    std::shared_ptr<View> heir_of;             ///< whose handle it takes over; tick thread only
    std::optional<render::ViewHandle> handle;  ///< none until the tick thread has made it; tick thread only
  };
  struct Waiting {
    std::shared_ptr<View> view;
    Clock::time_point until;
    std::shared_ptr<void> place;
  };
  using Views = std::vector<std::shared_ptr<View>>;

  void run();
  Result<void> load();
  void tickUntilStopped();
  void admitAndRelease();
  void inherit(View& heir);
  Views waitForDemand();
  /// What a tick renders for a view.
  struct Due {
    std::shared_ptr<View> view;
    ViewDemand demand;
  };
  using Dues = std::vector<Due>;
  void tick(const Views& wanted);
  /// `whole`: of this tick, if a picture is captured.
  Result<void> render(const world::ChangeSet& changes, const world::ChangeSet& whole, const Dues& dues);
  void renderEach(const world::ChangeSet& changes, const world::ChangeSet& whole, const Dues& dues);
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
  std::condition_variable idle_;
  Clock::time_point idle_until_ = Clock::time_point::min();  ///< min: at work
  std::weak_ptr<void> aside_;
  Views views_;                   ///< attached sinks
  Views leaving_;                 ///< detached, their views not freed yet
  std::vector<Waiting> waiting_;  ///< detached, and perhaps attached again
  telemetry::WorldCounters counters_;

  std::unique_ptr<world::World> content_;  // written before state_ becomes ready
  EditRate edit_rate_;
  WorldLog log_;                                // goes before content_
  render::WorldHandle handle_ = 0;              // tick thread only
  Clock::time_point last_tick_{};               // tick thread only
  std::optional<world::ChangeSet> unrendered_;  // tick thread only: changes of ticks that failed

  telemetry::EditLatency edit_latency_;
  std::thread thread_;  // last: everything else is there when it starts
};

}  // namespace helio::service
