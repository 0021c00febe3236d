// Cuts a damaged write-ahead log, while no server has it.
#pragma once

#include <cstdint>
#include <filesystem>

#include "base/result.h"

namespace helio::store {

struct WalRepair {
  uint64_t lost_transactions = 0;  ///< at most; each holds the edits of up to 10 ms, of any world
  std::filesystem::path kept;      ///< the folder that has the files as they were; empty: nothing was damaged
};

/// Cuts the write-ahead log of the log in `folder` behind its last transaction that can be trusted. That is tried on a
/// copy first, and the files as they were stay in a folder beside them. Worlds whose rows do not fit any more are
/// DATA_LOSS at the next start, and EditLog::repair() mends them. Errors: a server has the folder (unavailable); more
/// than `most_lost` transactions would go, and `value` says how many (conflict); what is left is no database
/// (damaged); then nothing is changed.
Result<WalRepair> repairWal(const std::filesystem::path& folder, uint64_t most_lost);

}  // namespace helio::store
