#include "store/edit_log.h"

#include <spdlog/fmt/fmt.h>

namespace helio::store {

Error noSuchWorld(const std::string& world) {
  return {ErrorKind::not_found, fmt::format("no log of a world \"{}\": acquire it first", world), "world", world, {}};
}

Error fencedEpoch(const std::string& world, uint64_t epoch) {
  return {ErrorKind::conflict,
          fmt::format("epoch {} of world \"{}\" is fenced: another server has it, or it was removed", epoch, world),
          "epoch",
          fmt::format("{}", epoch),
          {}};
}

Error snapshotOutOfRange(const std::string& world, uint64_t seq, uint64_t oldest, uint64_t newest) {
  return invalid(
      "seq", fmt::format("{}", seq),
      fmt::format("snapshot of world \"{}\" at seq {}: it must lie in [{}, {}]", world, seq, oldest, newest));
}

Error truncatesTooMuch(const std::string& world, uint64_t seq, uint64_t snapshot_seq) {
  return invalid("seq", fmt::format("{}", seq),
                 fmt::format("records of world \"{}\" up to {} are not all in its snapshot, which is at {}", world, seq,
                             snapshot_seq));
}

Error alreadyTruncated(const std::string& world, uint64_t after, uint64_t first_kept) {
  return {ErrorKind::conflict,
          fmt::format("world \"{}\" keeps records from {} on, not from {}: begin with its snapshot", world, first_kept,
                      after + 1),
          "after", fmt::format("{}", after), fmt::format("{}", first_kept - 1)};
}

Error losesTooMuch(const std::string& world, uint64_t lost, uint64_t most_lost) {
  return {
      ErrorKind::conflict,
      fmt::format("world \"{}\" cannot be repaired without losing {} of its edits, and {} were accepted; put back a "
                  "copy of the log that you trust, or accept the loss",
                  world, lost, most_lost),
      "accept_loss", fmt::format("{}", lost), fmt::format("{}", most_lost)};
}

}  // namespace helio::store
