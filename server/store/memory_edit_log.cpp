// The backend without durability: for tests, for demonstrations, and as the shortest reading of what a backend must do.
#include <algorithm>
#include <deque>
#include <map>
#include <mutex>
#include <unordered_map>
#include <utility>

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
      if (log.receipts.count(record.request_id) != 0) return Append::ok;
      if (record.seq != log.lastSeq() + 1) return Append::out_of_order;

      log.records.push_back(std::make_shared<const Record>(record));
      if (!record.request_id.empty()) log.receipts.emplace(record.request_id, Receipt{record.seq, record.receipt});
      const auto watched = watchers_.find(world);
      if (watched != watchers_.end()) {
        watchers = watched->second;
        watchers->enqueue(log.records.back());  // under the lock: the queue's order is the log's order
      }
    }
    if (watchers) watchers->deliver();
    return Append::ok;
  }

  Result<std::optional<Receipt>> receipt(const std::string& world, const std::string& request_id) const override {
    const std::lock_guard lock(mutex_);
    const auto entry = logs_.find(world);
    if (entry == logs_.end()) return std::optional<Receipt>();
    const auto found = entry->second.receipts.find(request_id);
    if (found == entry->second.receipts.end()) return std::optional<Receipt>();
    return std::optional(found->second);
  }

  Result<std::vector<Record>> read(const std::string& world, uint64_t after, size_t limit) const override {
    const std::lock_guard lock(mutex_);
    const auto entry = logs_.find(world);
    if (entry == logs_.end()) return noSuchWorld(world);
    const std::deque<RecordPtr>& records = entry->second.records;
    const uint64_t forgotten = entry->second.forgotten;
    if (after < forgotten) return alreadyTruncated(world, after, forgotten + 1);
    const size_t first = std::min<uint64_t>(after - forgotten, records.size());
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
    if (entry == logs_.end() || entry->second.epoch != epoch) return fencedEpoch(world, epoch);
    Log& log = entry->second;
    const uint64_t oldest = log.snapshotSeq();
    if (snapshot.seq < oldest || snapshot.seq > log.lastSeq())
      return snapshotOutOfRange(world, snapshot.seq, oldest, log.lastSeq());
    log.snapshot = snapshot;
    return {};
  }

  Result<std::optional<Snapshot>> snapshot(const std::string& world) const override {
    const std::lock_guard lock(mutex_);
    const auto entry = logs_.find(world);
    if (entry == logs_.end()) return noSuchWorld(world);
    return entry->second.snapshot;
  }

  Result<void> truncate(const std::string& world, uint64_t epoch, uint64_t seq) override {
    const std::lock_guard lock(mutex_);
    const auto entry = logs_.find(world);
    if (entry == logs_.end() || entry->second.epoch != epoch) return fencedEpoch(world, epoch);
    Log& log = entry->second;
    if (seq > log.snapshotSeq()) return truncatesTooMuch(world, seq, log.snapshotSeq());
    for (; log.forgotten < seq; ++log.forgotten) log.records.pop_front();
    return {};
  }

  Result<void> putManifest(const std::string& world, uint64_t epoch, const std::string& manifest) override {
    const std::lock_guard lock(mutex_);
    const auto entry = logs_.find(world);
    if (entry == logs_.end() || entry->second.epoch != epoch) return fencedEpoch(world, epoch);
    entry->second.manifest = manifest;
    return {};
  }

  Result<std::string> manifest(const std::string& world) const override {
    const std::lock_guard lock(mutex_);
    const auto entry = logs_.find(world);
    if (entry == logs_.end()) return noSuchWorld(world);
    return entry->second.manifest;
  }

  Result<std::vector<std::string>> worlds() const override {
    const std::lock_guard lock(mutex_);
    std::vector<std::string> names;
    for (const auto& [name, log] : logs_) names.push_back(name);
    return names;
  }

  Result<Repair> repair(const std::string& world, uint64_t) override {
    const std::lock_guard lock(mutex_);
    const auto entry = logs_.find(world);
    if (entry == logs_.end()) return noSuchWorld(world);
    return Repair{entry->second.lastSeq(), 0, 0};  // memory is never damaged
  }

  Result<void> remove(const std::string& world) override {
    const std::lock_guard lock(mutex_);
    if (logs_.erase(world) == 0) return noSuchWorld(world);
    return {};
  }

 private:
  struct Log {
    uint64_t epoch = 0;
    std::string manifest;
    uint64_t forgotten = 0;         // records up to here were truncated
    std::deque<RecordPtr> records;  // seq forgotten + 1, forgotten + 2, ...
    std::unordered_map<std::string, Receipt> receipts;
    std::optional<Snapshot> snapshot;

    uint64_t lastSeq() const { return forgotten + records.size(); }
    uint64_t snapshotSeq() const { return snapshot ? snapshot->seq : 0; }
  };

  mutable std::mutex mutex_;
  uint64_t last_epoch_ = 0;  // of all worlds, so that a world made again under its old name continues from there
  std::map<std::string, Log> logs_;
  std::unordered_map<std::string, std::shared_ptr<Watchers>> watchers_;  // outlive their worlds: watches are by name
};

}  // namespace

std::unique_ptr<EditLog> makeMemoryEditLog() { return std::make_unique<MemoryEditLog>(); }

}  // namespace helio::store
