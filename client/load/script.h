// One client of a load test: does its group's steps, in a closed or an open loop.
#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>
#include <random>
#include <string>
#include <vector>

#include "load/plot.h"
#include "load/relay.h"
#include "load/scenario.h"
#include "load/viewer.h"

namespace helio::load {

/// What all clients of a run share: when it ends.
class Curtain {
 public:
  explicit Curtain(Clock::time_point end) : end_(end) {}
  /// Waits until then. False: the run has ended before.
  bool waitUntil(Clock::time_point when);
  bool fallen() const;
  void fall();

 private:
  const Clock::time_point end_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  bool fallen_ = false;
};

/// A world as the clients of a run know it.
struct Stage {
  v1::World world;
  std::vector<v1::Prefab> prefabs;
  std::vector<client::View> mirrors;  ///< views of what look-at-mirror asks for; empty: nobody does
};

class Script {
 public:
  struct Part {
    const Group* group = nullptr;
    const Stage* stage = nullptr;
    std::string server;
    Plot plot;
    uint64_t seed = 0;
    Clock::time_point start;          ///< of this client
    Clock::time_point measured_from;  ///< the end of the warm-up
  };
  /// Errors: a camera or prefab that the steps name does not exist; no relay.
  static Result<std::unique_ptr<Script>> prepare(Part part, Curtain& curtain, Record& record);

  /// Until the curtain falls or the loops are done; then the viewer stays until the curtain falls.
  void run();
  /// Breaks off what it waits for; any thread.
  void cancel() { viewer_.cancel(); }

  const Plot& plot() const { return part_.plot; }

 private:
  Script(Part part, Curtain& curtain, Record& record);
  Result<void> check(const std::vector<Step>& steps) const;

  bool all(const std::vector<Step>& steps);
  bool one(const Step& step);
  Clock::time_point nextArrival();

  using When = Clock::time_point;
  Result<void> perform(const Attach& step, When intended);
  Result<void> perform(const Fly& step, When intended);
  Result<void> perform(const Jump& step, When intended);
  Result<void> perform(const LookAtMirror& step, When intended);
  Result<void> perform(const BuildStep& step, When intended);
  Result<void> perform(const DestroyStep& step, When intended);
  Result<void> perform(const Light& step, When intended);
  Result<void> perform(const Idle& step, When intended);
  Result<void> perform(const StopReading& step, When intended);
  Result<void> perform(const Vanish& step, When intended);
  Result<void> perform(const HalfOpen& step, When intended);
  Result<void> perform(const Reconnect& step, When intended);
  Result<void> perform(const Repeat&, When) { return {}; }  // all() has unrolled it

  Result<void> needAttached() const;
  Result<void> open(When intended, Series first);
  client::Connection& connection();
  void dropConnection();
  Result<v1::ApplyEditsResponse> apply(v1::ApplyEditsRequest request, When intended);
  const v1::NamedCamera* cameraNamed(const std::string& name) const;
  double uniform(double low, double high);

  Part part_;
  Curtain& curtain_;
  Record& record_;
  std::mt19937_64 random_;
  std::unique_ptr<Relay> relay_;
  std::unique_ptr<client::Connection> connection_;
  Viewer viewer_;
  client::View here_;
  int camera_ = 0;  ///< index of the named camera that it looks from
  Clock::time_point next_{};
};

}  // namespace helio::load
