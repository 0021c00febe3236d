// What a world renders for: a viewer's stream, or a shot.
#pragma once

#include <chrono>
#include <functional>
#include <optional>
#include <string>

#include "render/renderer.h"
#include "service/failure.h"
#include "telemetry/statistics.h"

namespace helio::service {

using telemetry::Clock;

/// One tick's picture of a view, and all that it shows.
struct Captured {
  render::Frame frame;  ///< with its radiance
  scene::Camera camera;
  render::ViewSettings settings;
  scene::ScenePtr scene;
  world::ChangeSet world;  ///< all of the world in that tick
};
using Capture = std::function<void(Captured)>;

struct ViewDemand {
  scene::Camera camera;
  render::ViewSettings settings;
  Capture capture{};  ///< gets this tick's picture too, on the tick thread
};

/// What telemetry shows of a viewer now.
struct ViewerStatus {
  uint64_t id = 0;
  std::string token;  ///< the id of its caller's; empty: a server without keys
  render::ViewSettings settings;
  telemetry::ViewerCounters counters;
  uint32_t unacknowledged = 0;
  uint32_t window = 0;
  std::optional<Clock::duration> round_trip;
  std::optional<Clock::time_point> last_acknowledged;
};

/// Called by the world's tick thread (end() and status() by any), never under a lock of the world's. None of these may
/// wait for a client.
class ViewSink {
 public:
  virtual ~ViewSink() = default;

  /// From when on a frame is wanted; none: not until the sink wakes its world.
  virtual std::optional<Clock::time_point> wantedFrom(Clock::time_point now) = 0;
  /// The tick begins: what to render. deliver() or end() follows, on the same thread.
  virtual ViewDemand demand(Clock::time_point now) = 0;
  virtual void deliver(render::Frame frame, Clock::duration tick) = 0;
  /// No more frames will come.
  virtual void end(const Failure& failure) = 0;
  /// Called about once a second by the server's housekeeping: whoever waits for a dead client finds out.
  virtual void tend(Clock::time_point) {}
  /// The next picture is captured as well. False: nobody captures pictures of these.
  virtual bool captureNext(Capture) { return false; }
  /// Shots have none.
  virtual std::optional<ViewerStatus> status() const { return std::nullopt; }
};

}  // namespace helio::service
