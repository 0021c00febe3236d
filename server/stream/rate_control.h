// How good and how many pictures a connection can carry: a rate from acknowledgements, a JPEG quality from the rate.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <optional>

namespace helio::stream {

/// Not thread-safe: its viewer's lock guards it.
///
/// The rate follows delay, as in delay-based congestion control (Brakmo and Peterson, TCP Vegas, 1995): the time that
/// an acknowledgement takes beyond the smallest round trip was spent in a queue on the way. While that is short the
/// rate grows; when it is not, the rate falls to less than what was delivered (bytes acknowledged over the time that
/// they took), so that the queue drains. The quality is the one at which pictures fit the rate at the frame rate
/// wanted; where the worst quality still does not fit, frames become fewer. Size and samples of pictures are not
/// touched.
class RateControl {
 public:
  using Clock = std::chrono::steady_clock;

  struct Wishes {
    uint32_t max_fps = 30;
    uint32_t max_kbps = 0;  ///< thousands of bits a second; 0: as much as the connection carries
    Clock::duration max_latency = std::chrono::seconds(1);
    int quality = 80;        ///< of a moving picture, at most
    int still_quality = 95;  ///< of a still one, at most
  };

  static constexpr int kWorstQuality = 25;  ///< below, blocks are what one sees

  explicit RateControl(const Wishes& wishes) { configure(wishes); }
  void configure(const Wishes& wishes);

  /// What to compress the next picture with. A still one may be as good as its wish, and takes the time it needs.
  int quality(bool still) const;

  /// A frame of `bytes`, compressed with `quality`, begins to be written.
  void sent(uint64_t id, uint64_t bytes, int quality, Clock::time_point now);
  /// The client has it, and everything before it. `round_trip`: without the time that the client held it; `smallest`:
  /// the smallest ever.
  void acknowledged(uint64_t id, Clock::duration round_trip, Clock::duration smallest, Clock::time_point now);

  /// Not before this may the next frame be sent.
  Clock::time_point nextFrame() const { return next_; }
  /// Bytes a second that frames may take now; none: no bound is known.
  std::optional<double> rate() const;

 private:
  struct Flying {
    uint64_t id;
    uint64_t bytes;
    Clock::time_point sent;
    uint64_t delivered_before;  ///< acknowledged when it was sent
  };
  void learnSize(uint64_t bytes, int quality);

  Wishes wishes_;
  std::deque<Flying> flying_;
  uint64_t delivered_ = 0;
  std::optional<double> rate_;  ///< from delay; none: nothing has ever queued
  Clock::time_point last_change_{};
  std::optional<double> log_size_;  ///< log2 of a picture's bytes at quality 50, smoothed
  Clock::time_point next_{};
};

}  // namespace helio::stream
