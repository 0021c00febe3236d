// One slot in which the newest waits. It stands before the encoder, so that no frame is encoded to be thrown away.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <utility>

namespace helio::stream {

using Clock = std::chrono::steady_clock;

/// Not thread-safe: its viewer's lock guards it.
template <typename T>
class Mailbox {
 public:
  struct Taken {
    T content;
    Clock::duration waited;
    uint32_t dropped_before;  ///< contents lost since the last one taken
  };

  /// Replaces what waits, and lets go of it.
  void put(T content, Clock::time_point now) {
    if (content_) ++dropped_;
    content_ = std::move(content);
    since_ = now;
  }

  /// Hands the content out, unless it has waited longer than `max_age`: then it is dropped.
  std::optional<Taken> take(Clock::time_point now, Clock::duration max_age) {
    if (!content_) return std::nullopt;
    if (now - since_ > max_age) {
      clear();
      return std::nullopt;
    }
    Taken taken{std::move(*content_), now - since_, dropped_};
    content_.reset();
    dropped_ = 0;
    return taken;
  }

  /// Drops what waits.
  void clear() {
    if (content_) ++dropped_;
    content_.reset();
  }

  bool empty() const { return !content_; }
  /// Contents lost since the last one taken.
  uint32_t dropped() const { return dropped_; }

 private:
  std::optional<T> content_;
  Clock::time_point since_{};
  uint32_t dropped_ = 0;
};

}  // namespace helio::stream
