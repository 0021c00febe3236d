// The durable backend: what every backend does, and what only a disk can do to it.
#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>
#include <sqlite3.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "edit_log_conformance.h"
#include "sqlite_files.h"
#include "store/log_folder.h"

namespace helio::store {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// Whatever folders the suite has made are removed at the end.
std::vector<std::unique_ptr<Folder>>& folders() {
  static std::vector<std::unique_ptr<Folder>> all;
  return all;
}

std::unique_ptr<EditLog> makeSqliteLog() {
  folders().push_back(std::make_unique<Folder>());
  return mustOpen(*folders().back());
}

INSTANTIATE_TEST_SUITE_P(Sqlite, EditLogConformance, ::testing::Values(Backend{"Sqlite", makeSqliteLog}));

TEST(SqliteEditLog, WhatWasAppendedIsThereAgain) {
  const Folder folder;
  uint64_t first = 0;
  {
    const auto log = mustOpen(folder);
    first = *log->acquire("w");
    ASSERT_TRUE(log->putManifest("w", first, "a city").ok());
    for (uint64_t seq = 1; seq <= 5; ++seq) ASSERT_EQ(log->append("w", first, record(seq)), Append::ok);
    ASSERT_TRUE(log->putSnapshot("w", first, {3, std::string(3'000'000, 's')}).ok());
    ASSERT_TRUE(log->truncate("w", first, 3).ok());
  }
  const auto log = mustOpen(folder);
  EXPECT_THAT(*log->worlds(), ElementsAre("w"));
  EXPECT_EQ(*log->manifest("w"), "a city");
  const auto second = log->acquire("w");
  ASSERT_TRUE(second.ok()) << second.error().message;
  EXPECT_GT(*second, first);
  EXPECT_EQ((*log->snapshot("w"))->seq, 3u);
  EXPECT_EQ((*log->snapshot("w"))->bytes, std::string(3'000'000, 's'));
  const auto records = log->read("w", 3, 10);
  ASSERT_TRUE(records.ok()) << records.error().message;
  ASSERT_EQ(records->size(), 2u);
  EXPECT_EQ(records->back().bytes, "bytes of 5");
  EXPECT_EQ((*log->receipt("w", "r1"))->bytes, "receipt of 1");
  EXPECT_EQ(log->append("w", first, record(6)), Append::fenced);
  EXPECT_EQ(log->append("w", *second, record(6)), Append::ok);
}

TEST(SqliteEditLog, WhatACrashLeavesInTheWriteAheadLogIsReadBack) {
  const Folder folder;
  writeAndCrash(folder, 20);
  ASSERT_GT(fs::file_size(folder / "edits.db-wal"), 0u);
  const auto log = mustOpen(folder);
  ASSERT_TRUE(log->acquire("w").ok());
  EXPECT_EQ(log->read("w", 0, 100)->size(), 20u);
}

/// What is logged while it lives.
class LogLines {
 public:
  LogLines() : before_(spdlog::default_logger()) {
    spdlog::set_default_logger(
        std::make_shared<spdlog::logger>("test", std::make_shared<spdlog::sinks::ostream_sink_mt>(text_)));
  }
  ~LogLines() { spdlog::set_default_logger(before_); }
  LogLines(const LogLines&) = delete;
  LogLines& operator=(const LogLines&) = delete;
  std::string text() const { return text_.str(); }

 private:
  std::shared_ptr<spdlog::logger> before_;
  std::ostringstream text_;
};

TEST(SqliteEditLog, AnIncompleteTailIsCutAndReported) {
  const Folder folder;
  writeAndCrash(folder, 20);
  // The last transaction wrote at least one page; half of its last one is missing.
  fs::resize_file(folder / "edits.db-wal", fs::file_size(folder / "edits.db-wal") - 2000);
  const auto tail = inspectWal(folder / "edits.db-wal", nullptr);
  ASSERT_TRUE(tail.ok()) << tail.error().message;
  EXPECT_GE(tail->incomplete_bytes, 2000u);
  const LogLines lines;
  const auto log = mustOpen(folder);
  EXPECT_THAT(lines.text(), HasSubstr("never complete, nor acknowledged; they were cut"));
  const auto epoch = log->acquire("w");
  ASSERT_TRUE(epoch.ok()) << epoch.error().message;
  EXPECT_EQ(log->read("w", 0, 100)->size(), 19u);
  EXPECT_EQ(log->append("w", *epoch, record(20)), Append::ok);
}

/// A crash that loses the first page of the last transaction and keeps the others, which the disk may do as it likes.
void loseABeginning(const Folder& folder, uint64_t begin) {
  constexpr uint64_t kIntoTheFirstPage = 100;
  damage(folder / "edits.db-wal", begin + kIntoTheFirstPage);
}

TEST(SqliteEditLog, TwoCrashesInARowAreNotDamage) {
  const auto copy = [](const Folder& from, const Folder& to) {
    for (const char* name : {"edits.db", "edits.db-wal"}) fs::copy_file(from / name, to / name);
  };
  const auto end = [](const Folder& folder) { return inspectWal(folder / "edits.db-wal", nullptr)->trusted_bytes; };
  const Folder first, second, third;
  {
    const auto log = mustOpen(first);
    const auto epoch = log->acquire("w");
    const uint64_t begin = end(first);
    Record long_one = record(1);
    long_one.bytes.assign(200'000, 'x');  // of many pages
    ASSERT_EQ(log->append("w", *epoch, long_one), Append::ok);
    copy(first, second);
    loseABeginning(second, begin);
  }
  {
    const auto log = mustOpen(second);
    const auto epoch = log->acquire("w");
    EXPECT_EQ(log->read("w", 0, 100)->size(), 0u);
    const uint64_t begin = end(second);
    ASSERT_EQ(log->append("w", *epoch, record(1)), Append::ok);  // of few
    copy(second, third);
    loseABeginning(third, begin);
  }
  const auto log = mustOpen(third);  // the pages of the first crash lay behind those of the second
  ASSERT_TRUE(log->acquire("w").ok());
  EXPECT_EQ(log->read("w", 0, 100)->size(), 0u);
}

// A frame's header begins 8 bytes before a sector does: the sector with the mark of a commit is an older frame's, the
// one with the salts is new.
TEST(SqliteEditLog, AnOlderCommitsMarkInATornFrameIsNoDamage) {
  constexpr uint64_t kHeader = 32, kFrame = 24 + 4096, kSector = 512;
  const Folder first, second;
  uint64_t begin = 0;
  {
    const auto log = mustOpen(first);
    const auto epoch = log->acquire("w");
    begin = inspectWal(first / "edits.db-wal", nullptr)->trusted_bytes;
    Record long_one = record(1);
    long_one.bytes.assign(600'000, 'x');  // of many pages
    ASSERT_EQ(log->append("w", *epoch, long_one), Append::ok);
    for (const char* name : {"edits.db", "edits.db-wal"}) fs::copy_file(first / name, second / name);
  }
  loseABeginning(second, begin);
  const uint64_t size = fs::file_size(second / "edits.db-wal");
  int torn = 0;
  std::fstream wal(second / "edits.db-wal", std::ios::in | std::ios::out | std::ios::binary);
  for (uint64_t frame = kHeader; frame + 2 * kFrame <= size; frame += kFrame) {
    if (frame < begin || frame % kSector != kSector - 8) continue;
    wal.seekp(static_cast<std::streamoff>(frame));
    wal.write("\0\0\0\5\0\0\0\7", 8);  // page 5, and a commit of 7 pages
    ++torn;
  }
  wal.close();
  ASSERT_GT(torn, 0);
  const auto log = mustOpen(second);
  ASSERT_TRUE(log->acquire("w").ok());
  EXPECT_EQ(log->read("w", 0, 100)->size(), 0u);
}

TEST(SqliteEditLog, DamageInTheWriteAheadLogIsNotTakenForItsEnd) {
  const Folder folder;
  writeAndCrash(folder, 20);
  damage(folder / "edits.db-wal", offsetOf(folder / "edits.db-wal", "bytes of 7"));
  for (int attempt = 0; attempt < 2; ++attempt) {  // a refused start changes nothing
    const Error error = errorOfOpening(folder);
    EXPECT_EQ(error.kind, ErrorKind::damaged);
    EXPECT_THAT(error.message, AllOf(HasSubstr("edits.db-wal is damaged"), HasSubstr("checksum")));
  }
}

TEST(SqliteEditLog, AWriteAheadLogWithoutItsHeaderIsDamaged) {
  const Folder folder;
  writeAndCrash(folder, 3);
  damage(folder / "edits.db-wal", 9);
  EXPECT_EQ(errorOfOpening(folder).kind, ErrorKind::damaged);
}

struct Wound {
  std::string name, text, expected;
};
std::ostream& operator<<(std::ostream& out, const Wound& wound) { return out << wound.name; }

class SqliteDamage : public ::testing::TestWithParam<Wound> {};

TEST_P(SqliteDamage, IsFoundWhenTheWorldIsAcquiredAndTouchesNoOtherWorld) {
  const Folder folder;
  {
    const auto log = mustOpen(folder);
    for (const char* world : {"w", "other"}) {
      const auto epoch = log->acquire(world);
      ASSERT_TRUE(log->putManifest(world, *epoch, fmt::format("manifest of {}", world)).ok());
      for (uint64_t seq = 1; seq <= 4; ++seq) {
        const std::string text = fmt::format("{} {}", world, seq);
        ASSERT_EQ(log->append(world, *epoch, {seq, "request " + text, "bytes " + text, "receipt " + text}), Append::ok);
      }
      ASSERT_TRUE(log->putSnapshot(world, *epoch, {2, fmt::format("snapshot of {}", world)}).ok());
    }
  }
  damage(folder / "edits.db", offsetOf(folder / "edits.db", GetParam().text));
  const auto log = mustOpen(folder);
  ASSERT_TRUE(log);
  const auto epoch = log->acquire("w");
  ASSERT_FALSE(epoch.ok());
  EXPECT_EQ(epoch.error().kind, ErrorKind::damaged);
  EXPECT_THAT(epoch.error().message, HasSubstr(GetParam().expected));
  EXPECT_TRUE(log->acquire("other").ok());
  EXPECT_TRUE(log->remove("w").ok());  // even so: somebody may want the name back
  EXPECT_TRUE(log->acquire("w").ok());
}

INSTANTIATE_TEST_SUITE_P(Sqlite, SqliteDamage,
                         ::testing::Values(Wound{"Record", "bytes w 3", "record 3 of world \"w\""},
                                           Wound{"Receipt", "receipt w 2", "receipt of request \"request w 2\""},
                                           Wound{"Manifest", "manifest of w", "the row of world \"w\""},
                                           Wound{"Snapshot", "snapshot of w", "snapshot of world \"w\""}),
                         [](const auto& wound) { return wound.param.name; });

TEST(SqliteEditLog, AMissingRowIsDamage) {
  for (const char* statement : {"DELETE FROM record WHERE seq = 2", "DELETE FROM request WHERE seq = 2",
                                "DELETE FROM record WHERE seq = 4", "UPDATE world SET last_seq = 3"}) {
    const Folder folder;
    {
      const auto log = mustOpen(folder);
      const auto epoch = log->acquire("w");
      for (uint64_t seq = 1; seq <= 4; ++seq) ASSERT_EQ(log->append("w", *epoch, record(seq)), Append::ok);
    }
    sql(folder, statement);
    const auto epoch = mustOpen(folder)->acquire("w");
    ASSERT_FALSE(epoch.ok()) << statement;
    EXPECT_EQ(epoch.error().kind, ErrorKind::damaged) << statement;
  }
}

TEST(SqliteEditLog, ANewerFormatIsRefusedByName) {
  const Folder folder;
  mustOpen(folder);
  sql(folder, "PRAGMA user_version = 7");
  const Error error = errorOfOpening(folder);
  EXPECT_EQ(error.kind, ErrorKind::unsupported);
  EXPECT_THAT(error.message, AllOf(HasSubstr("format 7"), HasSubstr("up to 1")));
}

TEST(SqliteEditLog, SomebodyElsesDatabaseIsRefusedAndLeftAlone) {
  const Folder folder;
  sql(folder, "CREATE TABLE songs (title)");
  const std::string before = contents(folder / "edits.db");
  EXPECT_EQ(errorOfOpening(folder).kind, ErrorKind::unsupported);
  EXPECT_EQ(contents(folder / "edits.db"), before);
}

TEST(SqliteEditLog, AFileThatIsNoDatabaseIsDamaged) {
  const Folder folder;
  std::ofstream(folder / "edits.db") << std::string(8192, 'x');
  EXPECT_EQ(errorOfOpening(folder).kind, ErrorKind::damaged);
}

TEST(SqliteEditLog, ASecondServerIsKeptOut) {
  const Folder folder;
  const auto log = mustOpen(folder);
  const Error error = errorOfOpening(folder);
  EXPECT_EQ(error.kind, ErrorKind::unavailable);
  EXPECT_THAT(error.message, HasSubstr("another heliographd"));
  EXPECT_TRUE(log->acquire("w").ok());
}

TEST(SqliteEditLog, WhatARemovedWorldLeftGoes) {
  const Folder folder;
  {
    const auto log = mustOpen(folder);
    const auto epoch = log->acquire("w");
    for (uint64_t seq = 1; seq <= 3; ++seq) ASSERT_EQ(log->append("w", *epoch, record(seq)), Append::ok);
    ASSERT_TRUE(log->putSnapshot("w", *epoch, {2, "snapshot"}).ok());
    ASSERT_TRUE(log->remove("w").ok());
  }
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open((folder / "edits.db").c_str(), &database), SQLITE_OK);
  for (const char* table : {"world", "record", "request", "snapshot_part", "waste"}) {
    sqlite3_stmt* statement = nullptr;
    sqlite3_prepare_v2(database, fmt::format("SELECT count(*) FROM {}", table).c_str(), -1, &statement, nullptr);
    ASSERT_EQ(sqlite3_step(statement), SQLITE_ROW);
    EXPECT_EQ(sqlite3_column_int(statement, 0), 0) << table;
    sqlite3_finalize(statement);
  }
  sqlite3_close(database);
}

TEST(LogFolder, NetworkFileSystemsAreKnownByTheirTypes) {
  EXPECT_EQ(networkFileSystem(0x6969), "NFS");
  EXPECT_EQ(networkFileSystem(static_cast<int>(0xff534d42u)), "CIFS");  // statfs' field is signed on some machines
  for (const long local :
       {0xef53L, 0x58465342L, 0x9123683eL, 0x01021994L, 0x794c7630L})  // ext4 xfs btrfs tmpfs overlay
    EXPECT_EQ(networkFileSystem(local), std::nullopt) << local;
}

TEST(LogFolder, ANetworkFileSystemIsRefusedByName) {
  const auto refused = checkFileSystem("/srv/worlds", 0x6969);
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().kind, ErrorKind::unsupported);
  EXPECT_THAT(refused.error().message,
              AllOf(HasSubstr("/srv/worlds"), HasSubstr("NFS"), HasSubstr("use a local disk")));
  EXPECT_TRUE(checkFileSystem("/srv/worlds", 0xef53).ok());
}

TEST(LogFolder, IsMadeAndMustBeAFolder) {
  const Folder folder;
  EXPECT_TRUE(prepareLogFolder(folder / "a/b").ok());
  EXPECT_TRUE(fs::is_directory(folder / "a/b"));
  EXPECT_EQ(fs::status(folder / "a/b").permissions(), fs::perms::owner_all);
  std::ofstream(folder / "file") << "x";
  const auto refused = prepareLogFolder(folder / "file");
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().kind, ErrorKind::invalid);
}

}  // namespace
}  // namespace helio::store
