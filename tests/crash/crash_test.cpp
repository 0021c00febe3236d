// Nothing acknowledged is lost, nothing is doubled, whenever the power goes.
#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <iostream>
#include <latch>
#include <thread>
#include <vector>

#include "crash/crash_test_run.h"
#include "crash/forgetful_vfs.h"
#include "store/sqlite_edit_log.h"

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
            << " snapshots, " << report.refused << " refused, " << report.unreadable << " unreadable" << std::endl;
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
  EXPECT_EQ(report->refused, 0u);
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

store::SqliteLogOptions optionsOn(const ForgetfulVfs& vfs) {
  store::SqliteLogOptions options;
  options.folder = "/";
  options.vfs = vfs.name();
  return options;
}

TEST(GroupCommit, WritersThatComeTogetherShareASync) {
  constexpr uint64_t kWriters = 8, kEdits = 20;
  ForgetfulVfs vfs("group", 1);
  vfs.setSyncTime(std::chrono::milliseconds(2));
  auto options = optionsOn(vfs);
  options.group_window = std::chrono::seconds(1);  // so that a slow machine tests the same
  const auto log = store::openSqliteEditLog(std::move(options));
  ASSERT_TRUE(log.ok()) << log.error().message;
  std::vector<uint64_t> epochs;
  for (uint64_t w = 0; w < kWriters; ++w) epochs.push_back(*(*log)->acquire(std::to_string(w)));

  const uint64_t before = vfs.syncs();
  std::latch all_here(kWriters);
  std::vector<std::thread> writers;
  for (uint64_t w = 0; w < kWriters; ++w)
    writers.emplace_back([&, w] {
      all_here.arrive_and_wait();
      for (uint64_t seq = 1; seq <= kEdits; ++seq)
        EXPECT_EQ((*log)->append(std::to_string(w), epochs[w], {seq, std::to_string(seq), "bytes", ""}),
                  store::Append::ok);
    });
  for (std::thread& writer : writers) writer.join();
  EXPECT_GE(vfs.syncs() - before, kEdits);
  EXPECT_LE(vfs.syncs() - before, kWriters * kEdits / 2);
}

TEST(GroupCommit, AfterADiskFailureNothingIsAcknowledgedAnyMore) {
  ForgetfulVfs vfs("failing", 1);
  auto options = optionsOn(vfs);
  std::vector<Error> fatal;
  options.on_fatal = [&](const Error& error) { fatal.push_back(error); };
  const auto log = store::openSqliteEditLog(std::move(options));
  ASSERT_TRUE(log.ok()) << log.error().message;
  const auto epoch = (*log)->acquire("w");
  ASSERT_EQ((*log)->append("w", *epoch, {1, "one", "bytes", ""}), store::Append::ok);
  vfs.crashNow();
  EXPECT_EQ((*log)->append("w", *epoch, {2, "two", "bytes", ""}), store::Append::unknown);
  ASSERT_EQ(fatal.size(), 1u);
  EXPECT_EQ(fatal.front().kind, ErrorKind::unavailable);
  vfs.restart();  // the disk is well again, but who knows what it has
  EXPECT_EQ((*log)->append("w", *epoch, {2, "two", "bytes", ""}), store::Append::unknown);
  EXPECT_FALSE((*log)->acquire("v").ok());
  EXPECT_EQ(fatal.size(), 1u);
}

}  // namespace
}  // namespace helio::crash
