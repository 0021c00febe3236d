// The tables of a log, row by row. Every row carries a checksum of its own, so that damage is found where it is read.
//
//   epoch          the greatest epoch ever given out
//   world          a row a world: its epoch, how far its records reach, its manifest, where its snapshot is
//   record         seq, request id, bytes of the records that are kept
//   request        request id, seq, receipt of every request there ever was
//   snapshot_part  a snapshot in parts of at most 1 MiB; those of other generations than the world's are waste
//   waste          ids of worlds that were removed, whose rows still have to go
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "store/edit_log.h"
#include "store/sqlite.h"

namespace helio::store {

/// A row that does not match its checksum, or one that is missing. Stays inside of store/, as SqliteFailure does.
struct Damage {
  std::string what;  ///< "record 17 of world \"city\""
};
Error toError(const Damage& damage, const std::string& path);

struct WorldRow {
  uint64_t id = 0;  ///< never used again
  std::string name;
  uint64_t epoch = 0;
  uint64_t forgotten = 0;  ///< records up to here were truncated
  uint64_t last_seq = 0;
  uint64_t requests = 0;  ///< rows in `request`
  uint64_t snapshot_seq = 0;
  uint64_t snapshot_parts = 0;
  uint64_t snapshot_generation = 0;  ///< 0: there is no snapshot
  std::string manifest;
};

/// What of a world can still be read.
struct Survey {
  bool intact = true;
  Repair repair;                      ///< what is left when the rest goes
  bool snapshot_goes = false;         ///< it cannot be read, and the records make up for it, or everything goes
  std::vector<std::string> requests;  ///< whose receipts cannot be read, or are of records that go
  uint64_t requests_left = 0;
};

/// Everything throws SqliteFailure, or Damage where a row is not what was written. Not thread-safe; writing needs a
/// transaction around it.
class SqliteTables {
 public:
  explicit SqliteTables(Database& database);

  static constexpr uint64_t kFormat = 1;
  enum class Kind { empty, ours, newer, foreign };
  /// Looks, and changes nothing.
  static Kind kindOf(Database& database);
  /// Makes the tables of an empty database.
  static void create(Database& database);

  uint64_t nextEpoch();

  std::optional<WorldRow> world(const std::string& name);
  std::vector<std::string> worldNames();
  /// Gives it its id.
  void insert(WorldRow& world);
  void update(const WorldRow& world);
  /// The row, intact or not; the rest becomes waste. False: there is none.
  bool remove(const std::string& name);
  /// Deletes some of what removed worlds left. False: there is nothing left.
  bool removeSomeWaste();

  void insert(const WorldRow& world, const Record& record);
  /// Without receipts.
  std::vector<Record> records(const WorldRow& world, uint64_t after, size_t limit);
  void removeRecords(const WorldRow& world, uint64_t up_to);

  void insertReceipt(const WorldRow& world, const std::string& request_id, const Receipt& receipt);
  std::optional<Receipt> receipt(const WorldRow& world, const std::string& request_id);

  void insertPart(const WorldRow& world, uint64_t generation, uint64_t part, std::string_view bytes);
  std::string snapshotBytes(const WorldRow& world);
  /// Deletes some parts of other generations than the world's. False: there were none.
  bool removeSomeParts(const WorldRow& world);

  /// Reads all that is kept of a world.
  void verify(const WorldRow& world);
  /// Likewise, and finds out what is left without what is damaged.
  Survey survey(const WorldRow& world);
  /// Deletes what the survey says, and stores the row.
  void giveUp(WorldRow world, const Survey& survey);

 private:
  uint64_t intactUpTo(const WorldRow& world, uint64_t after);

  Database& database_;
  Statement read_epoch_, write_epoch_;
  Statement read_world_, list_worlds_, insert_world_, update_world_, remove_world_;
  Statement read_waste_, add_waste_, remove_waste_, waste_records_, waste_requests_, waste_parts_;
  Statement insert_record_, read_records_, remove_records_, remove_records_after_;
  Statement insert_request_, read_request_, list_requests_, remove_request_;
  Statement insert_part_, read_parts_, remove_parts_;
};

}  // namespace helio::store
