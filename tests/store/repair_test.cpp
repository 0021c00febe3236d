// What is given up of a damaged log, and what is not: never more than was accepted, never without being told.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sqlite_files.h"
#include "store/wal_repair.h"

namespace helio::store {
namespace {

using ::testing::HasSubstr;

/// A log of world "w" with records 1..6, of which a snapshot at `snapshot` has made the first `truncated` superfluous;
/// and of world "other".
void write(const fs::path& folder, uint64_t snapshot, uint64_t truncated) {
  const auto log = mustOpen(folder);
  ASSERT_TRUE(log->append("other", *log->acquire("other"), {1, "request of other", "x", "x"}) == Append::ok);
  const auto epoch = log->acquire("w");
  ASSERT_TRUE(log->putManifest("w", *epoch, "manifest of w").ok());
  for (uint64_t seq = 1; seq <= 6; ++seq) ASSERT_EQ(log->append("w", *epoch, record(seq)), Append::ok);
  if (snapshot > 0) { ASSERT_TRUE(log->putSnapshot("w", *epoch, {snapshot, "snapshot of w"}).ok()); }
  ASSERT_TRUE(log->truncate("w", *epoch, truncated).ok());
}

struct Case {
  std::string name;
  uint64_t snapshot, truncated;  ///< see write()
  std::string wound;             ///< text in the file of which a byte is changed
  Repair left;
  bool snapshot_left;
};
std::ostream& operator<<(std::ostream& out, const Case& c) { return out << c.name; }

class Repairs : public ::testing::TestWithParam<Case> {};

TEST_P(Repairs, WhatIsAcceptedAndNoMore) {
  const Case& c = GetParam();
  const Folder folder;
  write(folder, c.snapshot, c.truncated);
  damage(folder / "edits.db", offsetOf(folder / "edits.db", c.wound));
  const auto log = mustOpen(folder);
  ASSERT_EQ(log->acquire("w").error().kind, ErrorKind::damaged);
  if (c.left.lost > 0) {
    const auto refused = log->repair("w", c.left.lost - 1);
    ASSERT_FALSE(refused.ok());
    EXPECT_EQ(refused.error().kind, ErrorKind::conflict);
    EXPECT_EQ(refused.error().value, fmt::format("{}", c.left.lost));
    EXPECT_EQ(log->acquire("w").error().kind, ErrorKind::damaged) << "a refusal changed something";
  }
  const auto repair = log->repair("w", c.left.lost);
  ASSERT_TRUE(repair.ok()) << repair.error().message;
  EXPECT_EQ(repair->last_seq, c.left.last_seq);
  EXPECT_EQ(repair->lost, c.left.lost);
  EXPECT_EQ(repair->forgotten_requests, c.left.forgotten_requests);

  // It is whole, says so, and goes on where it ends.
  const auto epoch = log->acquire("w");
  ASSERT_TRUE(epoch.ok()) << epoch.error().message;
  EXPECT_EQ(*log->manifest("w"), "manifest of w");
  EXPECT_EQ(log->snapshot("w")->has_value(), c.snapshot_left);
  const uint64_t from = c.snapshot_left ? c.snapshot : 0;
  const auto records = log->read("w", from, 100);
  ASSERT_TRUE(records.ok()) << records.error().message;
  ASSERT_EQ(records->size(), c.left.last_seq - from);
  for (const Record& kept : *records) EXPECT_EQ(kept.bytes, record(kept.seq).bytes);
  for (uint64_t seq = c.left.last_seq + 1; seq <= 6; ++seq)
    EXPECT_FALSE(log->find("w", record(seq).request_id)) << "a repeat of what was lost must be done again";
  EXPECT_EQ(log->append("w", *epoch, record(c.left.last_seq + 1)), Append::ok);
  EXPECT_EQ(log->repair("w", 0)->last_seq, c.left.last_seq + 1);
  EXPECT_TRUE(log->acquire("other").ok());
  EXPECT_TRUE(log->find("other", "request of other"));
}

INSTANTIATE_TEST_SUITE_P(
    Sqlite, Repairs,
    ::testing::Values(Case{"ARecord", 0, 0, "bytes of 4", {3, 3, 0}, false},
                      Case{"TheLastRecord", 2, 2, "bytes of 6", {5, 1, 0}, true},
                      Case{"ARecordBehindTheSnapshot", 2, 2, "bytes of 4", {3, 3, 0}, true},
                      Case{"ARecordThatIsInTheSnapshot", 3, 0, "bytes of 2", {6, 0, 0}, true},
                      Case{"ASnapshotWhoseRecordsAreThere", 3, 0, "snapshot of w", {6, 0, 0}, false},
                      Case{"ASnapshotWhoseRecordsAreNot", 3, 3, "snapshot of w", {0, 6, 0}, false},
                      Case{"AReceipt", 0, 0, "receipt of 2", {6, 0, 1}, false}),
    [](const auto& c) { return c.param.name; });

TEST(Repair, WhatSaysHowAWorldIsMadeCannotBeGuessed) {
  const Folder folder;
  write(folder, 0, 0);
  damage(folder / "edits.db", offsetOf(folder / "edits.db", "manifest of w"));
  const auto log = mustOpen(folder);
  EXPECT_EQ(log->repair("w", UINT64_MAX).error().kind, ErrorKind::damaged);
}

TEST(Repair, RecordsBehindTheEndAreDamageAndGo) {
  const Folder folder;
  write(folder, 0, 0);
  sql(folder, "INSERT INTO record SELECT world, 7, x'00', x'00', 0 FROM record WHERE seq = 6");
  const auto log = mustOpen(folder);
  ASSERT_EQ(log->acquire("w").error().kind, ErrorKind::damaged);
  ASSERT_TRUE(log->repair("w", 0).ok());
  EXPECT_EQ(log->append("w", *log->acquire("w"), record(7)), Append::ok);
}

// ---- The write-ahead log

TEST(WalRepair, CutsBehindWhatCanBeTrustedAndKeepsTheRest) {
  const Folder folder;
  writeAndCrash(folder, 20);
  damage(folder / "edits.db-wal", offsetOf(folder / "edits.db-wal", "bytes of 7"));
  const std::string before = contents(folder / "edits.db-wal");
  const Error told = errorOfOpening(folder);
  const uint64_t lost = inspectWal(folder / "edits.db-wal", nullptr)->lost_commits;
  EXPECT_GE(lost, 13u);
  EXPECT_THAT(told.message, HasSubstr(fmt::format("--accept-loss {}", lost)));

  const auto refused = repairWal(folder, lost - 1);
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().value, fmt::format("{}", lost));
  EXPECT_EQ(contents(folder / "edits.db-wal"), before);

  const auto repaired = repairWal(folder, lost);
  ASSERT_TRUE(repaired.ok()) << repaired.error().message;
  EXPECT_EQ(repaired->lost_transactions, lost);
  EXPECT_EQ(contents(repaired->kept / "edits.db-wal"), before) << "what was there is not there any more";
  const auto log = mustOpen(folder);
  const auto epoch = log->acquire("w");
  ASSERT_TRUE(epoch.ok()) << epoch.error().message;
  EXPECT_EQ(log->read("w", 0, 100)->size(), 6u);
  EXPECT_EQ(log->append("w", *epoch, record(7)), Append::ok);
}

TEST(WalRepair, WhatIsNotDamagedIsLeftAlone) {
  const Folder folder;
  writeAndCrash(folder, 5);
  const std::string before = contents(folder / "edits.db-wal");
  const auto repaired = repairWal(folder, 100);
  ASSERT_TRUE(repaired.ok()) << repaired.error().message;
  EXPECT_TRUE(repaired->kept.empty());
  EXPECT_EQ(contents(folder / "edits.db-wal"), before);
}

TEST(WalRepair, NotBehindAServersBackAndNotWhereThereIsNoLog) {
  const Folder folder, empty;
  const auto log = mustOpen(folder);
  EXPECT_EQ(repairWal(folder, 100).error().kind, ErrorKind::unavailable);
  EXPECT_EQ(repairWal(empty, 100).error().kind, ErrorKind::not_found);
  EXPECT_FALSE(fs::exists(empty / "edits.db"));
}

}  // namespace
}  // namespace helio::store
