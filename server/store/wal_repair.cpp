#include "store/wal_repair.h"

#include <fcntl.h>
#include <spdlog/fmt/fmt.h>
#include <unistd.h>

#include <string>

#include "store/sqlite.h"
#include "store/sqlite_tables.h"
#include "store/wal_inspection.h"

namespace helio::store {
namespace {

namespace fs = std::filesystem;

constexpr const char* kDatabase = "edits.db";
constexpr const char* kWal = "edits.db-wal";

Error refuse(ErrorKind kind, const fs::path& path, const std::string& why) {
  return {kind, fmt::format("{}: {}", path.string(), why), "log-dir", path.string(), {}};
}

/// Cuts a file and waits until the disk has it. Throws fs::filesystem_error.
void cut(const fs::path& file, uint64_t bytes) {
  fs::resize_file(file, bytes);
  const int descriptor = open(file.c_str(), O_RDWR | O_CLOEXEC);
  const bool synced = descriptor >= 0 && fsync(descriptor) == 0;
  const std::error_code error(errno, std::generic_category());
  if (descriptor >= 0) close(descriptor);
  if (!synced) throw fs::filesystem_error("cannot sync", file, error);
}

/// Database and write-ahead log, for the owner alone. Throws fs::filesystem_error.
void copyLog(const fs::path& from, const fs::path& to) {
  fs::create_directory(to);
  fs::permissions(to, fs::perms::owner_all);
  for (const char* name : {kDatabase, kWal}) fs::copy_file(from / name, to / name);
}

/// SQLite reads it, and finds its trees whole.
bool soundAfterCut(const fs::path& folder, uint64_t bytes) {
  cut(folder / kWal, bytes);
  try {
    Database database((folder / kDatabase).string(), nullptr);
    database.execute("PRAGMA locking_mode = EXCLUSIVE");
    if (SqliteTables::kindOf(database) != SqliteTables::Kind::ours) return false;
    Statement check(database.handle(), "PRAGMA integrity_check(1)");
    Query query(check);
    return query.step() && query.bytes(0) == "ok";
  } catch (const SqliteFailure&) { return false; }
}

/// A name that is free: before-repair-1, -2, ...
fs::path freeFolder(const fs::path& folder) {
  for (unsigned number = 1;; ++number) {
    const fs::path name = folder / fmt::format("before-repair-{}", number);
    if (!fs::exists(name)) return name;
  }
}

struct RemovedAtTheEnd {
  fs::path folder;
  ~RemovedAtTheEnd() {
    std::error_code ignored;
    fs::remove_all(folder, ignored);
  }
};

}  // namespace

Result<WalRepair> repairWal(const fs::path& folder, uint64_t most_lost) {
  const std::string path = (folder / kDatabase).string();
  if (!fs::exists(path)) return refuse(ErrorKind::not_found, folder, "has no log of heliographd");
  try {
    // As the server does it: the first read takes the lock.
    Database lock(path, nullptr);
    lock.execute("PRAGMA locking_mode = EXCLUSIVE");
    lock.keepWalOnClose(true);
    if (SqliteTables::kindOf(lock) != SqliteTables::Kind::ours)
      return refuse(ErrorKind::unsupported, path, "is no log that this program knows");
    const auto tail = inspectWal(path + "-wal", nullptr);
    if (!tail) return tail.error();
    if (tail->damage.empty()) return WalRepair{};
    if (tail->lost_commits > most_lost)
      return Error{ErrorKind::conflict,
                   fmt::format("{}-wal cannot be repaired without losing up to {} transactions, and {} were accepted; "
                               "put back a copy that you trust, or accept the loss",
                               path, tail->lost_commits, most_lost),
                   "accept-loss", std::to_string(tail->lost_commits), std::to_string(most_lost)};

    const RemovedAtTheEnd trial{folder / "repair-trial"};
    fs::remove_all(trial.folder);
    copyLog(folder, trial.folder);
    if (!soundAfterCut(trial.folder, tail->trusted_bytes))
      return refuse(ErrorKind::damaged, path,
                    "is no database any more without what is damaged in its write-ahead log; put back a copy that you "
                    "trust");
    const fs::path kept = freeFolder(folder);
    copyLog(folder, kept);
    cut(folder / kWal, tail->trusted_bytes);
    return WalRepair{tail->lost_commits, kept};
  } catch (const SqliteFailure& failure) {
    if (failure.busy()) return refuse(ErrorKind::unavailable, path, "a heliographd has this log; stop it first");
    return toError(failure, path);
  } catch (const fs::filesystem_error& error) {
    return refuse(ErrorKind::unavailable, error.path1(), error.code().message());
  }
}

}  // namespace helio::store
