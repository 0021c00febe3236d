// How many frames may be on their way to a client that acknowledges them.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <optional>

namespace helio::stream {

/// unacknowledged <= ceil(fps * smallest round trip) + 2, and no more than max_latency of frames. A fixed window of
/// three would cap the rate at 3 / round trip; two frames beyond the round trip keep the pipe full while one is being
/// encoded. Not thread-safe: its viewer's lock guards it.
class AckWindow {
 public:
  using Clock = std::chrono::steady_clock;

  AckWindow(uint32_t fps, Clock::duration max_latency) { configure(fps, max_latency); }
  void configure(uint32_t fps, Clock::duration max_latency);

  /// A frame's write begins. Ids ascend.
  void sent(uint64_t id, Clock::time_point now);
  /// The client has `id` and everything before it; it held the frame for `held` before saying so. False: no frame of
  /// that id is on its way (an old acknowledgement, or an invented one).
  bool acknowledged(uint64_t id, Clock::duration held, Clock::time_point now);

  /// Whether another frame may be sent: the window has room, and the oldest frame is younger than max_latency.
  bool open(Clock::time_point now) const;
  uint32_t size() const;
  uint32_t unacknowledged() const { return static_cast<uint32_t>(flying_.size()); }
  std::optional<Clock::duration> smallestRoundTrip() const { return smallest_; }
  /// Of the newest acknowledgement; zero: none yet.
  Clock::duration lastRoundTrip() const { return last_round_trip_; }
  /// How long the client has owed an acknowledgement; zero: it owes none.
  Clock::duration silence(Clock::time_point now) const;
  std::optional<Clock::time_point> lastAcknowledged() const { return last_; }

 private:
  struct Flying {
    uint64_t id;
    Clock::time_point sent;
  };
  uint32_t fps_ = 0;
  Clock::duration max_latency_{};
  std::deque<Flying> flying_;  // never longer than size() was
  std::optional<Clock::duration> smallest_;
  std::optional<Clock::time_point> last_;
  Clock::duration last_round_trip_{};
};

}  // namespace helio::stream
