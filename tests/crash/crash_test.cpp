// Nothing acknowledged is lost, nothing is doubled, whenever the power goes.
#include <gtest/gtest.h>

#include <cstdlib>
#include <iostream>

#include "crash/crash_test_run.h"

namespace helio::crash {
namespace {

/// HELIOGRAPH_CRASH_CYCLES, or what continuous integration has time for.
uint32_t cycles() {
  const char* wanted = std::getenv("HELIOGRAPH_CRASH_CYCLES");
  return wanted ? static_cast<uint32_t>(std::strtoul(wanted, nullptr, 10)) : 20;
}

void print(const Report& report) {
  std::cout << report.cycles << " crashes, " << report.acknowledged << " edits acknowledged, " << report.lost
            << " lost, " << report.doubled << " doubled, " << report.settled << " settled, " << report.snapshots
            << " snapshots, " << report.unreadable << " unreadable" << std::endl;
}

TEST(Crash, NothingAcknowledgedIsLostAndNothingIsDoubled) {
  Options options;
  options.cycles = cycles();
  const auto report = run(options);
  ASSERT_TRUE(report.ok()) << report.error().message;
  print(*report);
  EXPECT_EQ(report->cycles, options.cycles);
  EXPECT_EQ(report->lost, 0u);
  EXPECT_EQ(report->doubled, 0u);
  // The test must have had something to lose.
  EXPECT_GT(report->acknowledged, options.cycles * uint64_t{100});
  EXPECT_GT(report->settled, 0u);
  EXPECT_GT(report->snapshots, 0u);
}

// The same without syncs: if nothing were lost then, the test above would prove nothing.
TEST(Crash, WithoutSyncsEditsAreLost) {
  Options options;
  options.cycles = 20;
  options.synchronous = false;
  const auto report = run(options);
  ASSERT_TRUE(report.ok()) << report.error().message;
  print(*report);
  EXPECT_GT(report->lost, 0u);
}

}  // namespace
}  // namespace helio::crash
