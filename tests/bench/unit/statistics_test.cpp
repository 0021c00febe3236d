#include "bench/statistics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

namespace helio::bench {
namespace {

/// 1, 2, ..., count in an order that is not sorted.
std::vector<double> shuffled(size_t count) {
  std::vector<double> values(count);
  std::iota(values.begin(), values.end(), 1.0);
  std::shuffle(values.begin(), values.end(), std::mt19937(7));
  return values;
}

TEST(Median, IsTheMiddleOfAnOddNumber) {
  EXPECT_EQ(median({5.0}), 5.0);
  EXPECT_EQ(median({9.0, 1.0, 4.0}), 4.0);
  EXPECT_EQ(median(shuffled(101)), 51.0);
}

TEST(Median, IsTheMeanOfTheTwoInTheMiddleOfAnEvenNumber) {
  EXPECT_EQ(median({8.0, 2.0}), 5.0);
  EXPECT_EQ(median({100.0, 1.0, 3.0, 4.0}), 3.5);
  EXPECT_EQ(median(shuffled(100)), 50.5);
}

TEST(Percentile, IsTheNearestRank) {
  EXPECT_EQ(percentile(shuffled(100), 95), 95.0);
  EXPECT_EQ(percentile(shuffled(101), 95), 96.0);  // rank ceil(95.95)
  EXPECT_EQ(percentile(shuffled(20), 95), 19.0);   // 0.95 * 20 is exactly 19
  EXPECT_EQ(percentile(shuffled(19), 95), 19.0);
  EXPECT_EQ(percentile(shuffled(100), 1), 1.0);
  EXPECT_EQ(percentile(shuffled(100), 100), 100.0);
  EXPECT_EQ(percentile({3.5}, 95), 3.5);
}

// The definition itself, over many sizes: the smallest value that 95 percent of all do not exceed.
TEST(Percentile, MeetsItsDefinition) {
  for (size_t count = 1; count <= 200; ++count) {
    const double p95 = percentile(shuffled(count), 95);
    EXPECT_GE(100.0 * p95, 95.0 * static_cast<double>(count)) << count;
    EXPECT_LT(100.0 * (p95 - 1.0), 95.0 * static_cast<double>(count)) << count;
  }
}

TEST(Summary, HasBothAndZerosForNothing) {
  const Summary summary = summarise(shuffled(40));
  EXPECT_EQ(summary.median, 20.5);
  EXPECT_EQ(summary.p95, 38.0);
  EXPECT_EQ(summarise({}).median, 0.0);
  EXPECT_EQ(summarise({}).p95, 0.0);
}

}  // namespace
}  // namespace helio::bench
