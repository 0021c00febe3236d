// The durable backend: one SQLite database for all worlds of a server.
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>

#include "base/result.h"
#include "store/edit_log.h"

namespace helio::store {

struct SqliteLogOptions {
  /// The database and its write-ahead log are in here; made when it is missing.
  std::filesystem::path folder;
  /// Edits that come within this time of each other share a transaction, and its sync. Nobody waits who is alone: the
  /// log waits only while fewer writers have come than came to the last transaction.
  std::chrono::milliseconds group_window{10};
  /// Calls for a sync before an append is answered. False only to show what it is good for: a crash then loses edits.
  bool synchronous = true;
  /// Pages in the write-ahead log from which on they are written to the database.
  unsigned checkpoint_pages = 1000;
  /// SQLite's file system; empty: the system's, and the folder is looked at.
  std::string vfs;
  /// The disk or the database failed while writing. What was acknowledged is safe; nothing more will be: every later
  /// append is answered `unknown`. The process should end; a restart reads what is there. Called on a thread of the
  /// log.
  std::function<void(const Error&)> on_fatal;
};

/// Opens the log, making it if the folder is empty. What an unfinished transaction left is cut, and reported in the
/// server's log. Errors: see prepareLogFolder(); another server has the folder (unavailable); it was written by a newer
/// server or is none of ours (unsupported); damaged.
Result<std::unique_ptr<EditLog>> openSqliteEditLog(SqliteLogOptions options);

}  // namespace helio::store
