// Looks into SQLite's write-ahead log before SQLite does. SQLite takes the first frame that it cannot trust for the end
// of the log, whatever comes after it. After a crash that is right; after damage it would lose what was acknowledged.
#pragma once

#include <cstdint>
#include <string>

#include "base/result.h"

namespace helio::store {

struct WalTail {
  uint64_t commits = 0;           ///< transactions that SQLite will read
  uint64_t incomplete_bytes = 0;  ///< behind the last of them: of one transaction that was never acknowledged
};

/// `path` is the WAL's own ("edits.db-wal"); it need not exist. `vfs` null: the system's. Whoever writes it syncs each
/// transaction before beginning the next (synchronous=FULL), so that behind a frame that cannot be trusted at most the
/// rest of one transaction can lie. Errors: more than that (damaged); it cannot be read (unavailable).
/// Format: https://www.sqlite.org/fileformat2.html#walformat
Result<WalTail> inspectWal(const std::string& path, const char* vfs);

}  // namespace helio::store
