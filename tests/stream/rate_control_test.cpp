// The rate against links whose capacity, delay and queue are known.
#include "stream/rate_control.h"

#include <gtest/gtest.h>

#include <cmath>
#include <deque>

#include "stream/window.h"

namespace helio::stream {
namespace {

using namespace std::chrono_literals;
using Clock = RateControl::Clock;

struct Outcome {
  double frames_per_second = 0, bytes_per_second = 0, mean_quality = 0;
  double worst_queue = 0;  ///< seconds that a frame waited on the link, in the second half
};

/// Sends for `time` over a link of `capacity` bytes a second and `round_trip`, as a viewer's stream does: what the
/// window and the rate allow, at most `fps`. Figures are of the second half. Pictures take `at_50` bytes at quality 50.
Outcome run(RateControl& control, double capacity, Clock::duration round_trip, double at_50, Clock::duration time,
            uint32_t fps = 30, bool still = false, Clock::time_point begin = {}) {
  struct Flying {
    uint64_t id;
    Clock::time_point acknowledged;
  };
  AckWindow window(fps, 1s);
  std::deque<Flying> flying;
  Clock::time_point now = begin, link_free = begin, pace = begin;
  Outcome out;
  uint64_t id = 0, frames = 0;
  const auto half = now + time / 2, end = now + time;
  for (; now < end; now += 1ms) {
    while (!flying.empty() && flying.front().acknowledged <= now) {
      const auto at = flying.front().acknowledged;
      window.acknowledged(flying.front().id, 0ms, at);
      control.acknowledged(flying.front().id, window.lastRoundTrip(), *window.smallestRoundTrip(), at);
      flying.pop_front();
    }
    if (now < pace || now < control.nextFrame() || !window.open(now)) continue;
    pace = now + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(1.0 / fps));
    const int quality = control.quality(still);
    const double bytes = at_50 * std::exp2((quality - 50) / 20.0);  // not quite what the controller believes
    const auto start = std::max(now, link_free);
    link_free = start + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(bytes / capacity));
    control.sent(++id, static_cast<uint64_t>(bytes), quality, now);
    window.sent(id, now);
    flying.push_back({id, link_free + round_trip});
    if (now < half) continue;
    ++frames;
    out.mean_quality += quality;
    out.bytes_per_second += bytes;
    out.worst_queue = std::max(out.worst_queue, std::chrono::duration<double>(start - now).count());
  }
  const double seconds = std::chrono::duration<double>(time / 2).count();
  out.mean_quality /= static_cast<double>(std::max<uint64_t>(frames, 1));
  out.frames_per_second = static_cast<double>(frames) / seconds;
  out.bytes_per_second /= seconds;
  return out;
}

TEST(RateControl, AWideLinkGetsWhatWasAskedFor) {
  RateControl control({30, 0, 1s, 80, 95});
  const auto out = run(control, 100e6, 100ms, 40e3, 20s);
  EXPECT_EQ(out.mean_quality, 80);
  EXPECT_NEAR(out.frames_per_second, 29.4, 1.5);  // the simulation's clock has whole milliseconds
  EXPECT_FALSE(control.rate().has_value());
}

TEST(RateControl, ANarrowLinkGetsWorsePicturesAtTheSameRateAndNoLongQueue) {
  for (const auto round_trip : {10ms, 100ms}) {
    RateControl control({30, 0, 1s, 80, 95});
    const double capacity = 1e6;  // 30 frames of quality 80 would take 3.4 times as much
    const auto out = run(control, capacity, round_trip, 40e3, 60s);
    EXPECT_GT(out.bytes_per_second, 0.6 * capacity);
    EXPECT_LT(out.bytes_per_second, 1.02 * capacity);
    EXPECT_LT(out.worst_queue, 0.6) << "max_latency is 1 s, and a quarter of it counts as a queue";
    EXPECT_GT(out.frames_per_second, 20);
    EXPECT_LT(out.mean_quality, 60);
    EXPECT_GT(out.mean_quality, RateControl::kWorstQuality);
  }
}

TEST(RateControl, WhereTheWorstPictureDoesNotFitFramesBecomeFewer) {
  RateControl control({30, 0, 1s, 80, 95});
  const double capacity = 100e3;  // five frames of the worst quality
  const auto out = run(control, capacity, 50ms, 40e3, 60s);
  EXPECT_NEAR(out.mean_quality, RateControl::kWorstQuality, 2);
  EXPECT_GT(out.bytes_per_second, 0.5 * capacity);
  EXPECT_LT(out.frames_per_second, 8);
}

TEST(RateControl, AWishBoundsTheRateOnAnyLink) {
  RateControl control({30, 4'000, 1s, 80, 95});  // 500 kB/s
  const auto out = run(control, 100e6, 20ms, 40e3, 40s);
  EXPECT_LT(out.bytes_per_second, 500e3 * 1.05);
  EXPECT_GT(out.bytes_per_second, 500e3 * 0.7);
}

TEST(RateControl, ItRecoversWhenTheLinkDoes) {
  RateControl control({30, 0, 1s, 80, 95});
  run(control, 300e3, 50ms, 40e3, 30s);
  EXPECT_LT(control.quality(false), 60);
  // The same controller, later, on a link that has become wide.
  const auto out = run(control, 100e6, 50ms, 40e3, 60s, 30, false, Clock::time_point(30s));
  EXPECT_EQ(out.mean_quality, 80);
}

TEST(RateControl, AStillPictureIsSharper) {
  RateControl wide({30, 0, 1s, 80, 95});
  EXPECT_EQ(run(wide, 100e6, 20ms, 40e3, 10s, 30, true).mean_quality, 95);
  RateControl narrow({30, 0, 1s, 80, 95}), moving({30, 0, 1s, 80, 95});
  EXPECT_GT(run(narrow, 1e6, 20ms, 40e3, 40s, 30, true).mean_quality,
            run(moving, 1e6, 20ms, 40e3, 40s).mean_quality + 20);
}

}  // namespace
}  // namespace helio::stream
