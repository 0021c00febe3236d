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
  ok,            ///< durable (as durable as this backend is) under the sequence number asked for
  fenced,        ///< another server acquired the world, or it was removed: this epoch may not write any more
  unknown,       ///< the answer was lost: repeat with the same request id to learn it
  out_of_order,  ///< the sequence number is not the last one plus 1: nothing was written
};

struct Record {
  uint64_t seq = 0;
  std::string request_id;
  std::string bytes;
  std::string receipt;  ///< what a repeat of the request is told; kept when the record itself is forgotten
};

/// What is remembered of a request for as long as its world lives.
struct Receipt {
  uint64_t seq = 0;
  std::string bytes;
};

struct Snapshot {
  uint64_t seq = 0;  ///< everything up to here is in `bytes`
  std::string bytes;
};

/// What repair() left, and gave up.
struct Repair {
  uint64_t last_seq = 0;            ///< of what is kept
  uint64_t lost = 0;                ///< records behind it
  uint64_t forgotten_requests = 0;  ///< receipts of kept records: a repeat of such a request is done again
};

/// One log, many worlds. Thread-safe. Worlds come into being by acquire(). Every backend passes the suite in
/// tests/store/edit_log_conformance.h. Beside the errors that are named below, every call of a backend that keeps its
/// worlds on a disk may fail with `damaged` (what is there is not what was written) or `unavailable` (the disk).
class EditLog {
 public:
  virtual ~EditLog() = default;

  /// Takes the world over, new or not: returns a new epoch, greater than every earlier one of a world of this name,
  /// even of one that was removed. Earlier epochs are fenced. Everything that is kept of the world is looked through
  /// first. Errors: damaged; what is intact can still be read.
  virtual Result<uint64_t> acquire(const std::string& world) = 0;
  /// Appends under `seq`, which must be the last one plus 1 (a new world's first is 1). The same request id again
  /// answers `ok` and changes nothing, whatever its seq and bytes are; an empty request id is never the same. What is
  /// wrong is looked for in this order: fenced, a repeat, out_of_order.
  virtual Append append(const std::string& world, uint64_t epoch, const Record& record) = 0;
  /// What was appended under `request_id`, if it was.
  virtual Result<std::optional<Receipt>> receipt(const std::string& world, const std::string& request_id) const = 0;
  /// Its sequence number. Nothing, too, when the log cannot tell: append() decides.
  std::optional<uint64_t> find(const std::string& world, const std::string& request_id) const {
    const auto found = receipt(world, request_id);
    return found && *found ? std::optional((*found)->seq) : std::nullopt;
  }
  /// Records with seq > after, ascending, at most `limit`. Errors: no such world (not_found), records after `after`
  /// were truncated (conflict).
  virtual Result<std::vector<Record>> read(const std::string& world, uint64_t after, size_t limit) const = 0;
  /// Calls back for every record appended from now on, in order and one at a time, until the returned handle is
  /// destroyed: once its destructor has returned no call runs or comes. The world need not exist yet. Calls come from
  /// any thread, maybe after append() has returned; they may use the log and drop their own handle, and must not throw.
  virtual std::shared_ptr<void> watch(const std::string& world, std::function<void(const Record&)> on_record) = 0;
  /// Replaces the world's snapshot. Errors: a fenced epoch (conflict), a seq that is greater than the last record's or
  /// less than the present snapshot's (invalid).
  virtual Result<void> putSnapshot(const std::string& world, uint64_t epoch, const Snapshot& snapshot) = 0;
  /// The newest snapshot, or nothing when there is none yet. Errors: no such world (not_found).
  virtual Result<std::optional<Snapshot>> snapshot(const std::string& world) const = 0;
  /// Forgets the records up to `seq`; their receipts stay. Errors: a fenced epoch (conflict), a seq that is greater
  /// than the snapshot's (invalid).
  virtual Result<void> truncate(const std::string& world, uint64_t epoch, uint64_t seq) = 0;

  /// What the world is made of, in the caller's words. Errors: a fenced epoch (conflict).
  virtual Result<void> putManifest(const std::string& world, uint64_t epoch, const std::string& manifest) = 0;
  /// Empty when none was put. Errors: no such world (not_found).
  virtual Result<std::string> manifest(const std::string& world) const = 0;
  /// Names of all worlds, ascending.
  virtual Result<std::vector<std::string>> worlds() const = 0;

  /// Makes a damaged world whole: keeps its records up to the first that cannot be read, with what they need. (When the
  /// snapshot cannot be read, and the records before it were truncated, they need what is not there: nothing is kept
  /// but the manifest.) Every epoch is fenced, unless nothing was damaged. Errors: no such world (not_found), more than
  /// `most_lost` records would go, and `value` says how many (conflict), what says how the world is made is damaged
  /// itself (damaged); then nothing is changed.
  virtual Result<Repair> repair(const std::string& world, uint64_t most_lost) = 0;
  /// Forgets records, request ids, manifest and snapshot; every epoch is fenced. Errors: no such world (not_found).
  virtual Result<void> remove(const std::string& world) = 0;
};

// The errors that all backends share.
Error noSuchWorld(const std::string& world);
Error fencedEpoch(const std::string& world, uint64_t epoch);
Error snapshotOutOfRange(const std::string& world, uint64_t seq, uint64_t oldest, uint64_t newest);
Error truncatesTooMuch(const std::string& world, uint64_t seq, uint64_t snapshot_seq);
Error losesTooMuch(const std::string& world, uint64_t lost, uint64_t most_lost);
Error alreadyTruncated(const std::string& world, uint64_t after, uint64_t first_kept);

/// Lives as long as the process.
std::unique_ptr<EditLog> makeMemoryEditLog();

}  // namespace helio::store
