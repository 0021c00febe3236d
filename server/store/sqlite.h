// The little of SQLite's interface that the log needs, with owners and exceptions.
#pragma once

#include <cstdint>
#include <exception>
#include <string>
#include <string_view>
#include <utility>

#include "base/result.h"

struct sqlite3;
struct sqlite3_stmt;

namespace helio::store {

/// What SQLite answered instead of doing it. Stays inside of store/: toError() makes it fit for people.
class SqliteFailure : public std::exception {
 public:
  SqliteFailure(int code, std::string message) : code_(code), message_(std::move(message)) {}
  const char* what() const noexcept override { return message_.c_str(); }

  /// The database is not what SQLite wrote.
  bool damaged() const;
  /// Another connection has the database.
  bool busy() const;
  /// Nothing was written, and the next try may succeed.
  bool diskFull() const;

 private:
  int code_;  ///< extended result code
  std::string message_;
};

/// `damaged`, or `unavailable` with the disk's complaint. `path` names the database.
Error toError(const SqliteFailure& failure, const std::string& path);

/// A prepared statement. Bind, step, read, and it is ready to be bound again: see Query.
class Statement {
 public:
  Statement(sqlite3* database, const char* sql);
  ~Statement();
  Statement(const Statement&) = delete;
  Statement& operator=(const Statement&) = delete;

 private:
  friend class Query;
  sqlite3* database_;
  sqlite3_stmt* statement_ = nullptr;
};

/// One run of a statement. Parameters and columns count from 0. What it binds must live as long as it does.
class Query {
 public:
  template <typename... Values>
  explicit Query(Statement& statement, const Values&... values) : statement_(statement) {
    int index = 0;
    (bind(index++, values), ...);
  }
  ~Query();
  Query(const Query&) = delete;
  Query& operator=(const Query&) = delete;

  /// True: there is a row to read.
  bool step();
  /// For statements that return no rows; returns how many it changed.
  int run();

  uint64_t integer(int column) const;
  std::string bytes(int column) const;

 private:
  void bind(int index, uint64_t value);
  void bind(int index, std::string_view value);

  Statement& statement_;
};

/// One connection, which nobody else may have at the same time: its lock on the file lasts as long as it does.
class Database {
 public:
  /// `vfs` null: the system's.
  Database(const std::string& path, const char* vfs);
  ~Database();
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  /// Closing neither empties the write-ahead log nor deletes it.
  void keepWalOnClose(bool keep);
  void execute(const std::string& sql);
  uint64_t pragma(const std::string& name);
  /// Brings what the write-ahead log has into the database and empties it: the next transaction begins a new generation
  /// of frames, and none that lies in the file can be taken for one of them.
  void emptyWal();
  /// Undoes what was begun, if something was. Does not throw.
  void rollBack() noexcept;
  uint64_t lastRowId() const;
  sqlite3* handle() const { return database_; }

 private:
  sqlite3* database_ = nullptr;
};

}  // namespace helio::store
