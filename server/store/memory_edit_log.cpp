// The backend without durability: for tests, for demonstrations, and as the shortest reading of what a backend must do.
#include <algorithm>
#include <mutex>
#include <unordered_map>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "store/edit_log.h"
#include "store/watchers.h"

namespace helio::store {
namespace {

class MemoryEditLog final : public EditLog {
 public:
  Result<uint64_t> acquire(const std::string& world) override {
    const std::lock_guard lock(mutex_);
    return logs_[world].epoch = ++last_epoch_;
  }

  Append append(const std::string& world, uint64_t epoch, const Record& record) override {
    std::shared_ptr<Watchers> watchers;
    {
      const std::lock_guard lock(mutex_);
      const auto entry = logs_.find(world);
      if (entry == logs_.end() || entry->second.epoch != epoch) return Append::fenced;
      Log& log = entry->second;
      if (log.seq_of_request.count(record.request_id) != 0) return Append::ok;
      if (record.seq != log.records.size() + 1) return Append::out_of_order;

      log.records.push_back(std::make_shared<const Record>(record));
      if (!record.request_id.empty()) log.seq_of_request.emplace(record.request_id, record.seq);
      const auto watched = watchers_.find(world);
      if (watched != watchers_.end()) {
        watchers = watched->second;
        watchers->enqueue(log.records.back());  // under the lock: the queue's order is the log's order
      }
    }
    if (watchers) watchers->deliver();
    return Append::ok;
  }

  std::optional<uint64_t> find(const std::string& world, const std::string& request_id) const override {
    const std::lock_guard lock(mutex_);
    const auto entry = logs_.find(world);
    if (entry == logs_.end()) return std::nullopt;
    const auto request = entry->second.seq_of_request.find(request_id);
    if (request == entry->second.seq_of_request.end()) return std::nullopt;
    return request->second;
  }

  Result<std::vector<Record>> read(const std::string& world, uint64_t after, size_t limit) const override {
    const std::lock_guard lock(mutex_);
    const auto entry = logs_.find(world);
    if (entry == logs_.end()) return noSuchWorld(world);
    const std::vector<RecordPtr>& records = entry->second.records;
    const size_t first = std::min<uint64_t>(after, records.size());  // the record of seq is at seq - 1
    const size_t count = std::min(limit, records.size() - first);

    std::vector<Record> page;
    page.reserve(count);
    for (size_t i = first; i < first + count; ++i) page.push_back(*records[i]);
    return page;
  }

  std::shared_ptr<void> watch(const std::string& world, std::function<void(const Record&)> on_record) override {
    const std::lock_guard lock(mutex_);
    std::shared_ptr<Watchers>& watchers = watchers_[world];
    if (!watchers) watchers = std::make_shared<Watchers>();
    return watchers->add(std::move(on_record));
  }

  Result<void> putSnapshot(const std::string& world, uint64_t epoch, const Snapshot& snapshot) override {
    const std::lock_guard lock(mutex_);
    const auto entry = logs_.find(world);
    if (entry == logs_.end() || entry->second.epoch != epoch) {
      return Error{
          ErrorKind::conflict,
          fmt::format("epoch {} of world \"{}\" is fenced: another server has it, or it was removed", epoch, world),
          "epoch",
          fmt::format("{}", epoch),
          {}};
    }
    Log& log = entry->second;
    const uint64_t oldest = log.snapshot ? log.snapshot->seq : 0;
    if (snapshot.seq < oldest || snapshot.seq > log.records.size()) {
      return invalid("seq", fmt::format("{}", snapshot.seq),
                     fmt::format("snapshot of world \"{}\" at seq {}: it must lie in [{}, {}]", world, snapshot.seq,
                                 oldest, log.records.size()));
    }
    log.snapshot = snapshot;
    return {};
  }

  Result<std::optional<Snapshot>> snapshot(const std::string& world) const override {
    const std::lock_guard lock(mutex_);
    const auto entry = logs_.find(world);
    if (entry == logs_.end()) return noSuchWorld(world);
    return entry->second.snapshot;
  }

  Result<void> remove(const std::string& world) override {
    const std::lock_guard lock(mutex_);
    if (logs_.erase(world) == 0) return noSuchWorld(world);
    return {};
  }

 private:
  struct Log {
    uint64_t epoch = 0;
    std::vector<RecordPtr> records;  // seq 1, 2, ...
    std::unordered_map<std::string, uint64_t> seq_of_request;
    std::optional<Snapshot> snapshot;
  };

  static Error noSuchWorld(const std::string& world) {
    return {ErrorKind::not_found, fmt::format("no log of a world \"{}\": acquire it first", world), "world", world, {}};
  }

  mutable std::mutex mutex_;
  uint64_t last_epoch_ = 0;  // of all worlds, so that a world made again under its old name continues from there
  std::unordered_map<std::string, Log> logs_;
  std::unordered_map<std::string, std::shared_ptr<Watchers>> watchers_;  // outlive their worlds: watches are by name
};

}  // namespace

std::unique_ptr<EditLog> makeMemoryEditLog() { return std::make_unique<MemoryEditLog>(); }

}  // namespace helio::store
