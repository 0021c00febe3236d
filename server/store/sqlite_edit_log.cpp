#include "store/sqlite_edit_log.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <mutex>
#include <unordered_map>
#include <utility>

#include "store/group_commit.h"
#include "store/log_folder.h"
#include "store/sqlite_tables.h"
#include "store/wal_inspection.h"
#include "store/watchers.h"

namespace helio::store {
namespace {

constexpr size_t kPartBytes = 1 << 20;      // of a snapshot: what one transaction writes of it
constexpr uint64_t kTruncateAtOnce = 2000;  // records that one transaction deletes

class SqliteEditLog final : public EditLog {
 public:
  SqliteEditLog(SqliteLogOptions options, std::string path, std::unique_ptr<Database> database)
      : path_(std::move(path)),
        database_(std::move(database)),
        tables_(*database_),
        commits_(*database_, mutex_, path_, options.group_window, std::move(options.on_fatal)) {}

  Result<uint64_t> acquire(const std::string& world) override {
    auto verified = reading([&](SqliteTables& tables) -> Result<void> {
      if (const auto row = tables.world(world)) tables.verify(*row);
      return {};
    });
    if (!verified) return verified.error();
    uint64_t epoch = 0;
    auto written = writing([&]() -> Result<void> {
      auto row = tables_.world(world);
      epoch = tables_.nextEpoch();
      if (!row) {
        row = WorldRow{};
        row->name = world;
        tables_.insert(*row);
      }
      row->epoch = epoch;
      tables_.update(*row);
      return {};
    });
    if (!written) return written.error();
    return epoch;
  }

  Append append(const std::string& world, uint64_t epoch, const Record& record) override {
    Append answer = Append::unknown;
    std::shared_ptr<Watchers> watchers;
    const auto write = [&] {
      try {
        bool appended = false;
        answer = appendInTransaction(world, epoch, record, appended);
        if (appended) watchers = watchersOf(world);
      } catch (const Damage& damage) { spdlog::error("{}", toError(damage, path_).message); }
    };
    // Still under the lock: the order in which watchers are told is the log's.
    const auto committed = [&] {
      if (watchers) watchers->enqueue(std::make_shared<const Record>(record));
    };
    if (auto done = commits_.write(write, committed); !done) return Append::unknown;
    if (watchers) watchers->deliver();
    return answer;
  }

  Result<std::optional<Receipt>> receipt(const std::string& world, const std::string& request_id) const override {
    return reading([&](SqliteTables& tables) -> Result<std::optional<Receipt>> {
      const auto row = tables.world(world);
      if (!row || request_id.empty()) return std::optional<Receipt>();
      return tables.receipt(*row, request_id);
    });
  }

  Result<std::vector<Record>> read(const std::string& world, uint64_t after, size_t limit) const override {
    return reading([&](SqliteTables& tables) -> Result<std::vector<Record>> {
      const auto row = tables.world(world);
      if (!row) return noSuchWorld(world);
      if (after < row->forgotten) return alreadyTruncated(world, after, row->forgotten + 1);
      return tables.records(*row, after, limit);
    });
  }

  std::shared_ptr<void> watch(const std::string& world, std::function<void(const Record&)> on_record) override {
    const std::lock_guard lock(watchers_mutex_);
    std::shared_ptr<Watchers>& watchers = watchers_[world];
    if (!watchers) watchers = std::make_shared<Watchers>();
    return watchers->add(std::move(on_record));
  }

  /// A part a transaction, so that edits need not wait for all of it; it counts when the world's row says so.
  Result<void> putSnapshot(const std::string& world, uint64_t epoch, const Snapshot& snapshot) override {
    const std::lock_guard one_at_a_time(snapshot_mutex_);
    const auto fits = [&](const WorldRow& row) -> Result<void> {
      if (snapshot.seq < row.snapshot_seq || snapshot.seq > row.last_seq)
        return snapshotOutOfRange(world, snapshot.seq, row.snapshot_seq, row.last_seq);
      return {};
    };
    if (auto checked = changing(world, epoch, fits); !checked) return checked;
    if (auto swept = removeUnusedParts(world, epoch); !swept) return swept;

    const uint64_t parts = std::max<uint64_t>(1, (snapshot.bytes.size() + kPartBytes - 1) / kPartBytes);
    const std::string_view bytes = snapshot.bytes;
    for (uint64_t part = 0; part < parts; ++part) {
      auto put = changing(world, epoch, [&](WorldRow& row) -> Result<void> {
        tables_.insertPart(row, row.snapshot_generation + 1, part, bytes.substr(part * kPartBytes, kPartBytes));
        return {};
      });
      if (!put) return put;
    }
    auto switched = changing(world, epoch, [&](WorldRow& row) -> Result<void> {
      if (auto fit = fits(row); !fit) return fit;
      row.snapshot_seq = snapshot.seq;
      row.snapshot_parts = parts;
      ++row.snapshot_generation;
      return {};
    });
    if (!switched) return switched;
    return removeUnusedParts(world, epoch);
  }

  Result<std::optional<Snapshot>> snapshot(const std::string& world) const override {
    return reading([&](SqliteTables& tables) -> Result<std::optional<Snapshot>> {
      const auto row = tables.world(world);
      if (!row) return noSuchWorld(world);
      if (row->snapshot_generation == 0) return std::optional<Snapshot>();
      return std::optional(Snapshot{row->snapshot_seq, tables.snapshotBytes(*row)});
    });
  }

  Result<void> truncate(const std::string& world, uint64_t epoch, uint64_t seq) override {
    for (bool done = false; !done;) {
      auto removed = changing(world, epoch, [&](WorldRow& row) -> Result<void> {
        if (seq > row.snapshot_seq) return truncatesTooMuch(world, seq, row.snapshot_seq);
        done = seq <= row.forgotten + kTruncateAtOnce;
        row.forgotten = std::max(row.forgotten, std::min(seq, row.forgotten + kTruncateAtOnce));
        tables_.removeRecords(row, row.forgotten);
        return {};
      });
      if (!removed) return removed;
    }
    return {};
  }

  Result<void> putManifest(const std::string& world, uint64_t epoch, const std::string& manifest) override {
    return changing(world, epoch, [&](WorldRow& row) -> Result<void> {
      row.manifest = manifest;
      return {};
    });
  }

  Result<std::string> manifest(const std::string& world) const override {
    return reading([&](SqliteTables& tables) -> Result<std::string> {
      const auto row = tables.world(world);
      if (!row) return noSuchWorld(world);
      return row->manifest;
    });
  }

  Result<std::vector<std::string>> worlds() const override {
    return reading([&](SqliteTables& tables) -> Result<std::vector<std::string>> { return tables.worldNames(); });
  }

  /// One transaction: other worlds' edits wait for it.
  Result<Repair> repair(const std::string& world, uint64_t most_lost) override {
    Survey found;
    auto surveyed = reading([&](SqliteTables& tables) -> Result<void> {
      const auto row = tables.world(world);
      if (!row) return noSuchWorld(world);
      found = tables.survey(*row);
      if (found.repair.lost > most_lost) return losesTooMuch(world, found.repair.lost, most_lost);
      return {};
    });
    if (!surveyed) return surveyed.error();
    if (found.intact) return found.repair;
    auto written = writing([&]() -> Result<void> {
      auto row = tables_.world(world);
      if (!row) return noSuchWorld(world);
      row->epoch = tables_.nextEpoch();
      tables_.giveUp(*row, found);
      return {};
    });
    if (!written) return written.error();
    return found.repair;
  }

  Result<void> remove(const std::string& world) override {
    auto removed = writing([&]() -> Result<void> {
      if (!tables_.remove(world)) return noSuchWorld(world);
      return {};
    });
    if (!removed) return removed;
    return removeWaste();
  }

  /// What removed worlds left; a transaction at a time.
  Result<void> removeWaste() {
    for (bool more = true; more;) {
      auto removed = writing([&]() -> Result<void> {
        more = tables_.removeSomeWaste();
        return {};
      });
      if (!removed) return removed;
    }
    return {};
  }

 private:
  Append appendInTransaction(const std::string& world, uint64_t epoch, const Record& record, bool& appended) {
    auto row = tables_.world(world);
    if (!row || row->epoch != epoch) return Append::fenced;
    if (!record.request_id.empty() && tables_.receipt(*row, record.request_id)) return Append::ok;
    if (record.seq != row->last_seq + 1) return Append::out_of_order;

    tables_.insert(*row, record);
    if (!record.request_id.empty()) {
      tables_.insertReceipt(*row, record.request_id, {record.seq, record.receipt});
      ++row->requests;
    }
    row->last_seq = record.seq;
    tables_.update(*row);
    appended = true;
    return Append::ok;
  }

  std::shared_ptr<Watchers> watchersOf(const std::string& world) {
    const std::lock_guard lock(watchers_mutex_);
    const auto found = watchers_.find(world);
    return found == watchers_.end() ? nullptr : found->second;
  }

  Result<void> removeUnusedParts(const std::string& world, uint64_t epoch) {
    for (bool more = true; more;) {
      auto removed = changing(world, epoch, [&](WorldRow& row) -> Result<void> {
        more = tables_.removeSomeParts(row);
        return {};
      });
      if (!removed) return removed;
    }
    return {};
  }

  /// Calls `read` with the tables, and turns what it throws into an Error.
  template <typename Read>
  auto reading(Read read) const -> decltype(read(std::declval<SqliteTables&>())) {
    const std::lock_guard lock(mutex_);
    try {
      return read(tables_);
    } catch (const Damage& damage) { return toError(damage, path_); } catch (const SqliteFailure& failure) {
      return toError(failure, path_);
    }
  }

  /// Calls `write` in a transaction. What it finds wrong, it must find before its first change.
  template <typename Write>
  Result<void> writing(Write write) {
    Result<void> result;
    const auto work = [&] {
      try {
        result = write();
      } catch (const Damage& damage) { result = toError(damage, path_); }
    };
    if (auto committed = commits_.write(work, [] {}); !committed) return committed;
    return result;
  }

  /// Calls `change` with the world's row in a transaction, and stores the row. Errors: a fenced epoch.
  template <typename Change>
  Result<void> changing(const std::string& world, uint64_t epoch, Change change) {
    return writing([&]() -> Result<void> {
      auto row = tables_.world(world);
      if (!row || row->epoch != epoch) return fencedEpoch(world, epoch);
      if (auto changed = change(*row); !changed) return changed;
      tables_.update(*row);
      return {};
    });
  }

  const std::string path_;
  mutable std::mutex mutex_;  // guards the database
  std::unique_ptr<Database> database_;
  mutable SqliteTables tables_;
  std::mutex snapshot_mutex_;
  std::mutex watchers_mutex_;
  std::unordered_map<std::string, std::shared_ptr<Watchers>> watchers_;  // outlive their worlds: watches are by name
  GroupCommit commits_;                                                  // last: its thread uses all of the above
};

Error refuse(ErrorKind kind, const std::string& path, const std::string& why) {
  return {kind, fmt::format("{}: {}", path, why), "log-dir", path, {}};
}

}  // namespace

Result<std::unique_ptr<EditLog>> openSqliteEditLog(SqliteLogOptions options) {
  const char* vfs = options.vfs.empty() ? nullptr : options.vfs.c_str();
  if (options.vfs.empty())
    if (auto prepared = prepareLogFolder(options.folder); !prepared) return prepared.error();
  const std::string path = (options.folder / "edits.db").string();
  try {
    auto database = std::make_unique<Database>(path, vfs);
    // The first read takes the lock on the file, for good: a second server is refused instead of waiting.
    database->execute("PRAGMA locking_mode = EXCLUSIVE");
    database->keepWalOnClose(true);  // as it was found, as long as something may be wrong with it
    const auto kind = SqliteTables::kindOf(*database);
    const auto tail = inspectWal(path + "-wal", vfs);
    if (!tail) return tail.error();
    if (!tail->damage.empty()) return damagedWal(path + "-wal", *tail);
    if (kind == SqliteTables::Kind::foreign)
      return refuse(ErrorKind::unsupported, path, "is a database, but no log of heliographd; choose another folder");
    if (kind == SqliteTables::Kind::newer)
      return refuse(
          ErrorKind::unsupported, path,
          fmt::format("has format {}, this heliographd knows formats up to {}; start the newer one that wrote it",
                      database->pragma("user_version"), SqliteTables::kFormat));
    database->keepWalOnClose(false);
    database->execute("PRAGMA journal_mode = WAL");
    database->execute(options.synchronous ? "PRAGMA synchronous = FULL" : "PRAGMA synchronous = OFF");
    database->execute(fmt::format("PRAGMA wal_autocheckpoint = {}", options.checkpoint_pages));
    // SQLite would write over an incomplete tail frame by frame. What is left of it could be told from a later
    // transaction only until the next crash.
    database->emptyWal();
    if (kind == SqliteTables::Kind::empty) SqliteTables::create(*database);
    else if (tail->incomplete_bytes > 0)
      spdlog::warn(
          "{}: the last {} bytes of its write-ahead log are of a transaction that was never complete, nor "
          "acknowledged; they were cut",
          path, tail->incomplete_bytes);
    auto log = std::make_unique<SqliteEditLog>(std::move(options), path, std::move(database));
    if (auto swept = log->removeWaste(); !swept) return swept.error();
    return std::unique_ptr<EditLog>(std::move(log));
  } catch (const SqliteFailure& failure) {
    if (failure.busy())
      return refuse(ErrorKind::unavailable, path,
                    "another heliographd has this log; stop it, or choose another folder");
    return toError(failure, path);
  }
}

}  // namespace helio::store
