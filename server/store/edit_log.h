// Where a world's edits live. Knows bytes and sequence numbers, nothing of worlds.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/result.h"

namespace helio::store {

enum class Append {
  ok,       ///< durable (as durable as this backend is) under the sequence number asked for
  fenced,   ///< another server acquired the world: this epoch may not write any more
  unknown,  ///< the answer was lost: repeat with the same request id to learn it
};

struct Record {
  uint64_t seq = 0;
  std::string request_id;
  std::string bytes;
};

struct Snapshot {
  uint64_t seq = 0;  ///< everything up to here is in `bytes`
  std::string bytes;
};

/// One log, many worlds. Thread-safe.
class EditLog {
 public:
  virtual ~EditLog() = default;

  /// Takes the world over: returns a new epoch, greater than every earlier one. Earlier epochs are fenced.
  virtual Result<uint64_t> acquire(const std::string& world) = 0;
  /// Appends under `seq`, which must be the last one plus 1. The same request id again answers `ok` and changes nothing.
  virtual Append append(const std::string& world, uint64_t epoch, const Record& record) = 0;
  /// Sequence number that `request_id` was appended under, if it was.
  virtual std::optional<uint64_t> find(const std::string& world, const std::string& request_id) const = 0;
  /// Records with seq > after, ascending, at most `limit`.
  virtual Result<std::vector<Record>> read(const std::string& world, uint64_t after, size_t limit) const = 0;
  /// Calls back for every record appended from now on, in order, until the returned handle is destroyed.
  virtual std::shared_ptr<void> watch(const std::string& world, std::function<void(const Record&)> on_record) = 0;
  virtual Result<void> putSnapshot(const std::string& world, uint64_t epoch, const Snapshot& snapshot) = 0;
  virtual Result<std::optional<Snapshot>> snapshot(const std::string& world) const = 0;
  virtual Result<void> remove(const std::string& world) = 0;
};

/// Lives as long as the process.
std::unique_ptr<EditLog> makeMemoryEditLog();

}  // namespace helio::store
