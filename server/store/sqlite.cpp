#include "store/sqlite.h"

#include <spdlog/fmt/fmt.h>
#include <sqlite3.h>

namespace helio::store {
namespace {

[[noreturn]] void fail(sqlite3* database) {
  throw SqliteFailure(sqlite3_extended_errcode(database), sqlite3_errmsg(database));
}

}  // namespace

bool SqliteFailure::damaged() const { return (code_ & 0xff) == SQLITE_CORRUPT || (code_ & 0xff) == SQLITE_NOTADB; }
bool SqliteFailure::busy() const { return (code_ & 0xff) == SQLITE_BUSY; }
bool SqliteFailure::diskFull() const { return (code_ & 0xff) == SQLITE_FULL; }

Error toError(const SqliteFailure& failure, const std::string& path) {
  if (failure.damaged())
    return {ErrorKind::damaged,
            fmt::format("{} is damaged: {}; put back a copy that you trust", path, failure.what()),
            "log-dir",
            path,
            {}};
  if (failure.diskFull())
    return {
        ErrorKind::unavailable, fmt::format("the disk that holds {} is full: make room", path), "log-dir", path, {}};
  return {ErrorKind::unavailable, fmt::format("{}: {}; look at the disk", path, failure.what()), "log-dir", path, {}};
}

// ---- Statements
// ------------------------------------------------------------------------------------------------------

Statement::Statement(sqlite3* database, const char* sql) : database_(database) {
  if (sqlite3_prepare_v3(database, sql, -1, SQLITE_PREPARE_PERSISTENT, &statement_, nullptr) != SQLITE_OK)
    fail(database);
}

Statement::~Statement() { sqlite3_finalize(statement_); }

Query::~Query() {
  sqlite3_reset(statement_.statement_);
  sqlite3_clear_bindings(statement_.statement_);
}

bool Query::step() {
  switch (sqlite3_step(statement_.statement_)) {
    case SQLITE_ROW:
      return true;
    case SQLITE_DONE:
      return false;
    default:
      fail(statement_.database_);
  }
}

int Query::run() {
  while (step()) {}
  return sqlite3_changes(statement_.database_);
}

uint64_t Query::integer(int column) const {
  return static_cast<uint64_t>(sqlite3_column_int64(statement_.statement_, column));
}

std::string Query::bytes(int column) const {
  const auto* data = static_cast<const char*>(sqlite3_column_blob(statement_.statement_, column));
  const int size = sqlite3_column_bytes(statement_.statement_, column);
  return data ? std::string(data, static_cast<size_t>(size)) : std::string();
}

// Sequence numbers beyond what SQLite can hold are compared with, never stored.
void Query::bind(int index, uint64_t value) {
  if (sqlite3_bind_int64(statement_.statement_, index + 1, static_cast<sqlite3_int64>(value)) != SQLITE_OK)
    fail(statement_.database_);
}

void Query::bind(int index, std::string_view value) {
  // A null pointer would bind NULL, also with size 0.
  const char* data = value.empty() ? "" : value.data();
  if (sqlite3_bind_blob64(statement_.statement_, index + 1, data, value.size(), SQLITE_STATIC) != SQLITE_OK)
    fail(statement_.database_);
}

// ---- The connection
// --------------------------------------------------------------------------------------------------

Database::Database(const std::string& path, const char* vfs) {
  constexpr int kFlags = SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE | SQLITE_OPEN_FULLMUTEX | SQLITE_OPEN_EXRESCODE;
  const int opened = sqlite3_open_v2(path.c_str(), &database_, kFlags, vfs);
  if (opened == SQLITE_OK) return;
  const SqliteFailure failure(opened, database_ ? sqlite3_errmsg(database_) : "out of memory");
  sqlite3_close(database_);
  throw failure;
}

Database::~Database() { sqlite3_close_v2(database_); }

void Database::keepWalOnClose(bool keep) {
  sqlite3_db_config(database_, SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, int{keep}, nullptr);
}

void Database::execute(const std::string& sql) {
  if (sqlite3_exec(database_, sql.c_str(), nullptr, nullptr, nullptr) != SQLITE_OK) fail(database_);
}

uint64_t Database::pragma(const std::string& name) {
  Statement statement(database_, ("PRAGMA " + name).c_str());
  Query query(statement);
  return query.step() ? query.integer(0) : 0;
}

void Database::emptyWal() {
  if (pragma("wal_checkpoint(TRUNCATE)") != 0)  // its first column: whether somebody kept it from doing so
    throw SqliteFailure(SQLITE_BUSY, "the write-ahead log is in use by somebody else");
}

void Database::rollBack() noexcept {
  if (sqlite3_get_autocommit(database_) == 0) sqlite3_exec(database_, "ROLLBACK", nullptr, nullptr, nullptr);
}

uint64_t Database::lastRowId() const { return static_cast<uint64_t>(sqlite3_last_insert_rowid(database_)); }

}  // namespace helio::store
