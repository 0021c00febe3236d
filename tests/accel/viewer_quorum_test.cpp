// Every viewer counts once between two feedbacks, whatever its rate.
#include <gtest/gtest.h>

#include "accel/viewer_quorum.h"

namespace helio::accel {
namespace {

TEST(ViewerQuorum, ASlowViewerIsWaitedForAndAFastOneCountsOnce) {
  ViewerQuorum quorum;
  quorum.add(1);
  quorum.add(2);
  EXPECT_TRUE(quorum.counts(1, 10));
  EXPECT_TRUE(quorum.counts(2, 10));
  EXPECT_TRUE(quorum.complete(10));
  EXPECT_TRUE(quorum.counts(1, 11));
  EXPECT_FALSE(quorum.complete(11));
  EXPECT_FALSE(quorum.counts(1, 12));  // once in a round
  EXPECT_FALSE(quorum.complete(12));
  EXPECT_TRUE(quorum.counts(2, 13));
  EXPECT_TRUE(quorum.complete(13));
}

TEST(ViewerQuorum, NobodyWaitsForTheIdleTheGoneAndThoseWhoNeverCame) {
  ViewerQuorum quorum;
  for (const uint64_t viewer : {1, 2, 3}) quorum.add(viewer);
  EXPECT_TRUE(quorum.counts(1, 0));
  EXPECT_TRUE(quorum.counts(2, 0));
  EXPECT_TRUE(quorum.complete(0));
  for (uint64_t tick = 1; tick < ViewerQuorum::kIdleAfter; ++tick) {
    (void)quorum.counts(1, tick);
    EXPECT_FALSE(quorum.complete(tick)) << tick;
  }
  (void)quorum.counts(1, ViewerQuorum::kIdleAfter);
  EXPECT_TRUE(quorum.complete(ViewerQuorum::kIdleAfter));
  quorum.remove(2);
  EXPECT_TRUE(quorum.counts(1, ViewerQuorum::kIdleAfter + 1));
  EXPECT_TRUE(quorum.complete(ViewerQuorum::kIdleAfter + 1));
  EXPECT_FALSE(quorum.complete(ViewerQuorum::kIdleAfter + 2));  // nobody rendered
}

}  // namespace
}  // namespace helio::accel
