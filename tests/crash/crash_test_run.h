// Writers, a crash at a random moment, a restart, and a look at what is left; again and again. Test and benchmark share
// it.
#pragma once

#include <cstdint>
#include <functional>

#include "base/result.h"

namespace helio::crash {

struct Options {
  uint32_t cycles = 20;
  bool synchronous = true;  ///< false: the log does not sync, and must lose
  uint64_t seed = 1;
  std::function<void()> on_cycle;  ///< progress
};

struct Report {
  uint64_t cycles = 0;
  uint64_t acknowledged = 0;  ///< edits
  uint64_t lost = 0;          ///< acknowledged, and not there, or not as they were, after a restart
  uint64_t doubled = 0;       ///< there twice
  uint64_t settled = 0;       ///< repeated after an unknown outcome
  uint64_t snapshots = 0;
  uint64_t refused = 0;     ///< times the log refused a write before any crash: a log that syncs never does
  uint64_t unreadable = 0;  ///< restarts that found a log which cannot be opened: all of it counts as lost
};

/// Two worlds with two writers each, and their snapshots. Errors: what the log itself complains about before any crash.
Result<Report> run(const Options& options);

}  // namespace helio::crash
