#include "stream/window.h"

#include <gtest/gtest.h>

#include <memory>

#include "stream/mailbox.h"

namespace helio::stream {
namespace {

using namespace std::chrono_literals;
const AckWindow::Clock::time_point kStart{};

TEST(AckWindow, LetsTwoFlyBeforeAnythingIsKnown) {
  AckWindow window(30, 1s);
  EXPECT_TRUE(window.open(kStart));
  window.sent(1, kStart);
  EXPECT_TRUE(window.open(kStart));
  window.sent(2, kStart);
  EXPECT_FALSE(window.open(kStart));
}

TEST(AckWindow, HoldsTheFramesOfOneRoundTripAndTwo) {
  // ceil(fps * round trip) + 2
  for (const auto& [fps, round_trip, frames] :
       {std::tuple{30u, 100ms, 5u}, {60u, 100ms, 8u}, {60u, 200ms, 14u}, {30u, 1ms, 3u}}) {
    AckWindow window(fps, 10s);
    window.sent(1, kStart);
    ASSERT_TRUE(window.acknowledged(1, 0ms, kStart + round_trip));
    EXPECT_EQ(window.size(), frames) << fps << " frames/s";
  }
}

TEST(AckWindow, TakesTheSmallestRoundTripWithoutTheTimeHeld) {
  AckWindow window(60, 10s);
  window.sent(1, kStart);
  window.acknowledged(1, 50ms, kStart + 150ms);
  EXPECT_EQ(*window.smallestRoundTrip(), 100ms);
  window.sent(2, kStart + 1s);
  window.acknowledged(2, 0ms, kStart + 1s + 400ms);
  EXPECT_EQ(*window.smallestRoundTrip(), 100ms);
  window.sent(3, kStart + 2s);
  window.acknowledged(3, 5s, kStart + 2s + 10ms);  // a lie cannot make it negative
  EXPECT_EQ(*window.smallestRoundTrip(), 0ms);
}

TEST(AckWindow, IsBoundedByTheLatencyAllowed) {
  AckWindow window(60, 100ms);  // six frames are 100 ms
  window.sent(1, kStart);
  window.acknowledged(1, 0ms, kStart + 3s);
  EXPECT_EQ(window.size(), 6u);
  window.configure(1, 10ms);  // never less than one, or nothing would ever be sent
  EXPECT_EQ(window.size(), 1u);
}

TEST(AckWindow, ClosesWhenTheOldestIsTooOld) {
  AckWindow window(60, 200ms);
  window.sent(1, kStart);
  EXPECT_TRUE(window.open(kStart + 200ms));
  EXPECT_FALSE(window.open(kStart + 201ms));
  window.acknowledged(1, 0ms, kStart + 300ms);
  EXPECT_TRUE(window.open(kStart + 300ms));
}

TEST(AckWindow, OneAcknowledgementCoversWhatCameBefore) {
  AckWindow window(60, 10s);
  window.sent(1, kStart);
  window.sent(2, kStart);
  EXPECT_TRUE(window.acknowledged(2, 0ms, kStart + 1ms));
  EXPECT_EQ(window.unacknowledged(), 0u);
  EXPECT_FALSE(window.acknowledged(1, 0ms, kStart + 2ms)) << "acknowledged before";
  EXPECT_FALSE(window.acknowledged(99, 0ms, kStart + 2ms)) << "never sent";
}

TEST(Mailbox, TheNewestWinsAndTheOldIsLetGo) {
  Mailbox<std::shared_ptr<int>> mailbox;
  const auto first = std::make_shared<int>(1), second = std::make_shared<int>(2);
  mailbox.put(first, kStart);
  mailbox.put(second, kStart + 5ms);
  EXPECT_EQ(first.use_count(), 1) << "the mailbox still holds the replaced frame";
  EXPECT_EQ(mailbox.dropped(), 1u);
  const auto taken = mailbox.take(kStart + 8ms, 1s);
  EXPECT_EQ(mailbox.dropped(), 0u);
  ASSERT_TRUE(taken);
  EXPECT_EQ(*taken->content, 2);
  EXPECT_EQ(taken->dropped_before, 1u);
  EXPECT_EQ(taken->waited, 3ms);
  EXPECT_TRUE(mailbox.empty());
  EXPECT_FALSE(mailbox.take(kStart + 8ms, 1s));
}

TEST(Mailbox, DropsWhatIsTooOldAndCountsIt) {
  Mailbox<int> mailbox;
  mailbox.put(1, kStart);
  EXPECT_FALSE(mailbox.take(kStart + 2s, 1s));
  EXPECT_TRUE(mailbox.empty());
  mailbox.put(2, kStart + 3s);
  EXPECT_EQ(mailbox.take(kStart + 3s, 1s)->dropped_before, 1u);
}

}  // namespace
}  // namespace helio::stream
