#include "store/sqlite_tables.h"

#include <openssl/sha.h>
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cstring>

namespace helio::store {
namespace {

constexpr uint64_t kApplication = 0x48474c47;  // "HGLG", in the header of the file

constexpr const char* kSchema = R"(
CREATE TABLE epoch (id INTEGER PRIMARY KEY, last INTEGER NOT NULL, checksum INTEGER NOT NULL);
CREATE TABLE world (
  id INTEGER PRIMARY KEY AUTOINCREMENT, name BLOB NOT NULL UNIQUE, epoch INTEGER NOT NULL,
  forgotten INTEGER NOT NULL, last_seq INTEGER NOT NULL, requests INTEGER NOT NULL,
  snapshot_seq INTEGER NOT NULL, snapshot_parts INTEGER NOT NULL, snapshot_generation INTEGER NOT NULL,
  manifest BLOB NOT NULL, checksum INTEGER NOT NULL);
CREATE TABLE record (
  world INTEGER NOT NULL, seq INTEGER NOT NULL, request_id BLOB NOT NULL, bytes BLOB NOT NULL,
  checksum INTEGER NOT NULL, PRIMARY KEY (world, seq)) WITHOUT ROWID;
CREATE TABLE request (
  world INTEGER NOT NULL, request_id BLOB NOT NULL, seq INTEGER NOT NULL, receipt BLOB NOT NULL,
  checksum INTEGER NOT NULL, PRIMARY KEY (world, request_id)) WITHOUT ROWID;
CREATE TABLE snapshot_part (
  world INTEGER NOT NULL, generation INTEGER NOT NULL, part INTEGER NOT NULL, bytes BLOB NOT NULL,
  checksum INTEGER NOT NULL, PRIMARY KEY (world, generation, part));
CREATE TABLE waste (world INTEGER PRIMARY KEY);
)";

// How much one transaction deletes, so that edits need not wait long for it.
constexpr uint64_t kRowsAtOnce = 2000, kPartsAtOnce = 8;

/// The first 64 bits of SHA-256 over a row's fields, each with its length in front.
class Checksum {
 public:
  explicit Checksum(std::string_view table) { add(table); }
  Checksum& add(uint64_t value) {
    for (int shift = 0; shift < 64; shift += 8) fields_.push_back(static_cast<char>(value >> shift & 0xff));
    return *this;
  }
  Checksum& add(std::string_view value) {
    add(uint64_t{value.size()});
    fields_.append(value);
    return *this;
  }
  uint64_t value() const {
    unsigned char digest[SHA256_DIGEST_LENGTH];
    SHA256(reinterpret_cast<const unsigned char*>(fields_.data()), fields_.size(), digest);
    uint64_t first;
    std::memcpy(&first, digest, sizeof first);
    return first;
  }

 private:
  std::string fields_;
};

uint64_t checksumOf(const WorldRow& w) {
  return Checksum("world")
      .add(w.id)
      .add(w.name)
      .add(w.epoch)
      .add(w.forgotten)
      .add(w.last_seq)
      .add(w.requests)
      .add(w.snapshot_seq)
      .add(w.snapshot_parts)
      .add(w.snapshot_generation)
      .add(w.manifest)
      .value();
}
uint64_t checksumOf(uint64_t world, const Record& r) {
  return Checksum("record").add(world).add(r.seq).add(r.request_id).add(r.bytes).value();
}
uint64_t checksumOf(uint64_t world, std::string_view request_id, const Receipt& r) {
  return Checksum("request").add(world).add(request_id).add(r.seq).add(r.bytes).value();
}
uint64_t checksumOfPart(uint64_t world, uint64_t generation, uint64_t part, std::string_view bytes) {
  return Checksum("snapshot_part").add(world).add(generation).add(part).add(bytes).value();
}
uint64_t checksumOfEpoch(uint64_t last) { return Checksum("epoch").add(last).value(); }

void expect(bool intact, const std::string& what) {
  if (!intact) throw Damage{what};
}

}  // namespace

Error toError(const Damage& damage, const std::string& path) {
  return {ErrorKind::damaged,
          fmt::format("{}: {} is not what was written; put back a copy of the log that you trust", path, damage.what),
          "log-dir",
          path,
          {}};
}

SqliteTables::Kind SqliteTables::kindOf(Database& database) {
  const uint64_t application = database.pragma("application_id"), format = database.pragma("user_version");
  Statement tables(database.handle(), "SELECT count(*) FROM sqlite_master");
  Query query(tables);
  query.step();
  if (application == 0 && format == 0 && query.integer(0) == 0) return Kind::empty;
  if (application != kApplication) return Kind::foreign;
  return format == kFormat ? Kind::ours : Kind::newer;
}

void SqliteTables::create(Database& database) {
  database.execute("BEGIN IMMEDIATE");
  database.execute(kSchema);
  database.execute(fmt::format("PRAGMA application_id = {}", kApplication));
  database.execute(fmt::format("PRAGMA user_version = {}", kFormat));
  {
    Statement first(database.handle(), "INSERT INTO epoch VALUES (1, 0, ?)");
    Query(first, checksumOfEpoch(0)).run();
  }
  database.execute("COMMIT");
}

SqliteTables::SqliteTables(Database& d)
    : database_(d),
      read_epoch_(d.handle(), "SELECT last, checksum FROM epoch"),
      write_epoch_(d.handle(), "UPDATE epoch SET last = ?, checksum = ?"),
      read_world_(d.handle(),
                  "SELECT id, epoch, forgotten, last_seq, requests, snapshot_seq, snapshot_parts, snapshot_generation, "
                  "manifest, checksum FROM world WHERE name = ?"),
      list_worlds_(d.handle(), "SELECT name FROM world ORDER BY name"),
      insert_world_(d.handle(), "INSERT INTO world VALUES (NULL, ?, 0, 0, 0, 0, 0, 0, 0, x'', 0)"),
      update_world_(d.handle(),
                    "UPDATE world SET epoch = ?, forgotten = ?, last_seq = ?, requests = ?, snapshot_seq = ?, "
                    "snapshot_parts = ?, snapshot_generation = ?, manifest = ?, checksum = ? WHERE id = ?"),
      remove_world_(d.handle(), "DELETE FROM world WHERE name = ?"),
      read_waste_(d.handle(), "SELECT world FROM waste LIMIT 1"),
      add_waste_(d.handle(), "INSERT INTO waste SELECT id FROM world WHERE name = ?"),
      remove_waste_(d.handle(), "DELETE FROM waste WHERE world = ?"),
      waste_records_(
          d.handle(),
          "DELETE FROM record WHERE world = ?1 AND seq IN (SELECT seq FROM record WHERE world = ?1 LIMIT ?2)"),
      waste_requests_(d.handle(),
                      "DELETE FROM request WHERE world = ?1 AND request_id IN "
                      "(SELECT request_id FROM request WHERE world = ?1 LIMIT ?2)"),
      waste_parts_(
          d.handle(),
          "DELETE FROM snapshot_part WHERE rowid IN (SELECT rowid FROM snapshot_part WHERE world = ? LIMIT ?)"),
      insert_record_(d.handle(), "INSERT INTO record VALUES (?, ?, ?, ?, ?)"),
      read_records_(
          d.handle(),
          "SELECT seq, request_id, bytes, checksum FROM record WHERE world = ? AND seq > ? ORDER BY seq LIMIT ?"),
      remove_records_(d.handle(), "DELETE FROM record WHERE world = ? AND seq <= ?"),
      remove_records_after_(d.handle(), "DELETE FROM record WHERE world = ? AND seq > ?"),
      insert_request_(d.handle(), "INSERT INTO request VALUES (?, ?, ?, ?, ?)"),
      read_request_(d.handle(), "SELECT seq, receipt, checksum FROM request WHERE world = ? AND request_id = ?"),
      list_requests_(d.handle(), "SELECT request_id, seq, receipt, checksum FROM request WHERE world = ?"),
      remove_request_(d.handle(), "DELETE FROM request WHERE world = ? AND request_id = ?"),
      insert_part_(d.handle(), "INSERT INTO snapshot_part VALUES (?, ?, ?, ?, ?)"),
      read_parts_(d.handle(),
                  "SELECT part, bytes, checksum FROM snapshot_part WHERE world = ? AND generation = ? ORDER BY part"),
      remove_parts_(d.handle(),
                    "DELETE FROM snapshot_part WHERE rowid IN "
                    "(SELECT rowid FROM snapshot_part WHERE world = ? AND generation != ? LIMIT ?)") {}

uint64_t SqliteTables::nextEpoch() {
  uint64_t last = 0;
  {
    Query query(read_epoch_);
    expect(query.step(), "the epoch");
    last = query.integer(0);
    expect(query.integer(1) == checksumOfEpoch(last), "the epoch");
  }
  ++last;
  Query(write_epoch_, last, checksumOfEpoch(last)).run();
  return last;
}

// ---- Worlds
// ----------------------------------------------------------------------------------------------------------

std::optional<WorldRow> SqliteTables::world(const std::string& name) {
  Query query(read_world_, name);
  if (!query.step()) return std::nullopt;
  WorldRow row;
  row.id = query.integer(0);
  row.name = name;
  row.epoch = query.integer(1);
  row.forgotten = query.integer(2);
  row.last_seq = query.integer(3);
  row.requests = query.integer(4);
  row.snapshot_seq = query.integer(5);
  row.snapshot_parts = query.integer(6);
  row.snapshot_generation = query.integer(7);
  row.manifest = query.bytes(8);
  expect(query.integer(9) == checksumOf(row), fmt::format("the row of world \"{}\"", name));
  return row;
}

std::vector<std::string> SqliteTables::worldNames() {
  std::vector<std::string> names;
  Query query(list_worlds_);
  while (query.step()) names.push_back(query.bytes(0));
  return names;
}

void SqliteTables::insert(WorldRow& world) {
  Query(insert_world_, world.name).run();
  world.id = database_.lastRowId();
  update(world);
}

void SqliteTables::update(const WorldRow& w) {
  Query(update_world_, w.epoch, w.forgotten, w.last_seq, w.requests, w.snapshot_seq, w.snapshot_parts,
        w.snapshot_generation, w.manifest, checksumOf(w), w.id)
      .run();
}

bool SqliteTables::remove(const std::string& name) {
  Query(add_waste_, name).run();
  return Query(remove_world_, name).run() > 0;
}

bool SqliteTables::removeSomeWaste() {
  uint64_t world = 0;
  {
    Query query(read_waste_);
    if (!query.step()) return false;
    world = query.integer(0);
  }
  const int rows = Query(waste_records_, world, kRowsAtOnce).run() + Query(waste_requests_, world, kRowsAtOnce).run() +
                   Query(waste_parts_, world, kPartsAtOnce).run();
  if (rows == 0) Query(remove_waste_, world).run();
  return true;
}

// ---- Records and receipts
// --------------------------------------------------------------------------------------------

void SqliteTables::insert(const WorldRow& world, const Record& record) {
  Query(insert_record_, world.id, record.seq, record.request_id, record.bytes, checksumOf(world.id, record)).run();
}

std::vector<Record> SqliteTables::records(const WorldRow& world, uint64_t after, size_t limit) {
  std::vector<Record> records;
  if (after >= world.last_seq) return records;
  const uint64_t wanted = std::min<uint64_t>(limit, world.last_seq - after);
  Query query(read_records_, world.id, after, wanted);
  for (uint64_t seq = after + 1; seq <= after + wanted; ++seq) {
    const std::string what = fmt::format("record {} of world \"{}\"", seq, world.name);
    expect(query.step(), what);
    Record record{query.integer(0), query.bytes(1), query.bytes(2), {}};
    expect(record.seq == seq && query.integer(3) == checksumOf(world.id, record), what);
    records.push_back(std::move(record));
  }
  return records;
}

void SqliteTables::removeRecords(const WorldRow& world, uint64_t up_to) {
  Query(remove_records_, world.id, up_to).run();
}

void SqliteTables::insertReceipt(const WorldRow& world, const std::string& request_id, const Receipt& receipt) {
  Query(insert_request_, world.id, request_id, receipt.seq, receipt.bytes, checksumOf(world.id, request_id, receipt))
      .run();
}

std::optional<Receipt> SqliteTables::receipt(const WorldRow& world, const std::string& request_id) {
  Query query(read_request_, world.id, request_id);
  if (!query.step()) return std::nullopt;
  Receipt receipt{query.integer(0), query.bytes(1)};
  expect(query.integer(2) == checksumOf(world.id, request_id, receipt),
         fmt::format("the receipt of request \"{}\" of world \"{}\"", request_id, world.name));
  return receipt;
}

// ---- Snapshots
// -------------------------------------------------------------------------------------------------------

void SqliteTables::insertPart(const WorldRow& world, uint64_t generation, uint64_t part, std::string_view bytes) {
  Query(insert_part_, world.id, generation, part, bytes, checksumOfPart(world.id, generation, part, bytes)).run();
}

std::string SqliteTables::snapshotBytes(const WorldRow& world) {
  std::string snapshot;
  Query query(read_parts_, world.id, world.snapshot_generation);
  for (uint64_t part = 0; part < world.snapshot_parts; ++part) {
    const std::string what = fmt::format("part {} of the snapshot of world \"{}\"", part, world.name);
    expect(query.step(), what);
    const std::string bytes = query.bytes(1);
    expect(query.integer(0) == part &&
               query.integer(2) == checksumOfPart(world.id, world.snapshot_generation, part, bytes),
           what);
    snapshot += bytes;
  }
  return snapshot;
}

bool SqliteTables::removeSomeParts(const WorldRow& world) {
  return Query(remove_parts_, world.id, world.snapshot_generation, kPartsAtOnce).run() > 0;
}

void SqliteTables::verify(const WorldRow& world) {
  constexpr size_t kPage = 256;
  for (uint64_t after = world.forgotten; after < world.last_seq; after += kPage) records(world, after, kPage);
  expect(world.forgotten <= world.snapshot_seq && world.snapshot_seq <= world.last_seq,
         fmt::format("the row of world \"{}\"", world.name));
  snapshotBytes(world);
  {
    Query beyond(read_records_, world.id, world.last_seq, uint64_t{1});
    expect(!beyond.step(), fmt::format("the end of world \"{}\"", world.name));
  }

  uint64_t requests = 0;
  Query query(list_requests_, world.id);
  for (; query.step(); ++requests) {
    const std::string request_id = query.bytes(0);
    const Receipt receipt{query.integer(1), query.bytes(2)};
    expect(query.integer(3) == checksumOf(world.id, request_id, receipt) && receipt.seq <= world.last_seq,
           fmt::format("the receipt of request \"{}\" of world \"{}\"", request_id, world.name));
  }
  expect(requests == world.requests,
         fmt::format("the receipts of world \"{}\": {} of {} are there", world.name, requests, world.requests));
}

// ---- Repair
// ----------------------------------------------------------------------------------------------------------

/// The last record up to which all after `after` can be read.
uint64_t SqliteTables::intactUpTo(const WorldRow& world, uint64_t after) {
  uint64_t seq = after;
  Query query(read_records_, world.id, after, world.last_seq - after);
  for (; query.step(); ++seq) {
    const Record record{query.integer(0), query.bytes(1), query.bytes(2), {}};
    if (record.seq != seq + 1 || query.integer(3) != checksumOf(world.id, record)) break;
  }
  return seq;
}

Survey SqliteTables::survey(const WorldRow& world) {
  Survey survey;
  try {
    verify(world);
    survey.repair.last_seq = world.last_seq;
    return survey;
  } catch (const Damage&) { survey.intact = false; }

  uint64_t from = world.snapshot_seq;
  try {
    snapshotBytes(world);
  } catch (const Damage&) {
    survey.snapshot_goes = true;
    from = 0;
  }
  // Without a snapshot, only records from the first on lead anywhere.
  const bool reachable = !survey.snapshot_goes || world.forgotten == 0;
  survey.repair.last_seq = reachable ? intactUpTo(world, from) : 0;
  survey.repair.lost = world.last_seq - survey.repair.last_seq;

  uint64_t found = 0;
  Query query(list_requests_, world.id);
  for (; query.step(); ++found) {
    const std::string request_id = query.bytes(0);
    const Receipt receipt{query.integer(1), query.bytes(2)};
    const bool intact = query.integer(3) == checksumOf(world.id, request_id, receipt);
    if (intact && receipt.seq <= survey.repair.last_seq) {
      ++survey.requests_left;
      continue;
    }
    survey.requests.push_back(request_id);
    if (!intact) ++survey.repair.forgotten_requests;
  }
  survey.repair.forgotten_requests += world.requests - std::min(found, world.requests);
  return survey;
}

void SqliteTables::giveUp(WorldRow world, const Survey& survey) {
  Query(remove_records_after_, world.id, survey.repair.last_seq).run();
  for (const std::string& request_id : survey.requests) Query(remove_request_, world.id, request_id).run();
  world.last_seq = survey.repair.last_seq;
  world.requests = survey.requests_left;
  if (survey.snapshot_goes) {
    world.snapshot_seq = world.snapshot_parts = world.snapshot_generation = world.forgotten = 0;
    while (removeSomeParts(world)) {}
  } else {  // what is in the snapshot needs no records any more, damaged or not
    world.forgotten = world.snapshot_seq;
    removeRecords(world, world.forgotten);
  }
  update(world);
}

}  // namespace helio::store
