// Looks into SQLite's write-ahead log before SQLite does. SQLite takes the first frame that it cannot trust for the end
// of the log, whatever comes after it. After a crash that is right; after damage it would lose what was acknowledged.
#pragma once

#include <cstdint>
#include <string>

#include "base/result.h"

namespace helio::store {

struct WalTail {
  uint64_t commits = 0;           ///< transactions that SQLite will read
  uint64_t trusted_bytes = 0;     ///< up to the end of the last of them
  uint64_t incomplete_bytes = 0;  ///< behind that: of one transaction that was never acknowledged
  /// More lies behind than that: the file is not what was written. Empty: it is.
  std::string damage;
  uint64_t lost_commits = 0;  ///< with damage: transactions behind the trusted ones, at most
};

/// `path` is the WAL's own ("edits.db-wal"); it need not exist. `vfs` null: the system's. Whoever writes it syncs each
/// transaction before beginning the next (synchronous=FULL), so that behind a frame that cannot be trusted at most the
/// rest of one transaction can lie; more is damage. Errors: it cannot be read (unavailable).
/// Format: https://www.sqlite.org/fileformat2.html#walformat
Result<WalTail> inspectWal(const std::string& path, const char* vfs);

/// `damaged`, for the log whose write-ahead log is at `path`.
Error damagedWal(const std::string& path, const WalTail& tail);

}  // namespace helio::store
