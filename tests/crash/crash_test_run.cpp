#include "crash/crash_test_run.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <map>
#include <memory>
#include <mutex>
#include <random>
#include <sstream>
#include <string>
#include <thread>
#include <unordered_map>
#include <vector>

#include "crash/forgetful_vfs.h"
#include "store/sqlite_edit_log.h"

namespace helio::crash {
namespace {

using store::Append;
using store::EditLog;

constexpr int kWorlds = 2, kWritersAWorld = 2;
constexpr uint64_t kLongestRun = 18'000;   // operations of the disk before the crash, at most
constexpr uint64_t kSnapshotEvery = 100;   // edits, and as many as a quarter of the world
constexpr unsigned kCheckpointPages = 40;  // small, so that crashes fall into checkpoints too

/// What the world is made of: which request stands at which sequence number. It is its own snapshot.
struct Content {
  std::vector<std::string> requests;  // of seq 1, 2, ...

  std::string snapshot() const {
    std::string bytes;
    for (const std::string& request : requests) bytes += request + "\n";
    return bytes;
  }
  static Content restored(const std::string& bytes) {
    Content content;
    std::istringstream lines(bytes);
    for (std::string line; std::getline(lines, line);) content.requests.push_back(line);
    return content;
  }
};

/// A world as its clients know it.
struct Model {
  std::string name;
  std::mutex mutex;  // as in the server: what is appended is applied before the next is appended
  Content content;
  uint64_t epoch = 0;
  uint64_t next_request = 1;
  uint64_t snapshot_seq = 0;
  uint64_t looked_at = 0;                        // records up to here were there after an earlier crash
  std::map<std::string, uint64_t> acknowledged;  // request: seq
  std::vector<std::string> unknown;              // requests whose answer the crash swallowed
};

std::string payload(const std::string& request) {
  return "bytes of " + request + std::string(request.size() * 37 % 700, '.');
}

class Run {
 public:
  explicit Run(const Options& options) : options_(options), vfs_("forgetful", options.seed), random_(options.seed) {
    for (int world = 0; world < kWorlds; ++world) {
      models_.push_back(std::make_unique<Model>());
      models_.back()->name = "world-" + std::to_string(world);
    }
  }

  Result<Report> run() {
    for (uint32_t cycle = 0; cycle < options_.cycles; ++cycle) {
      if (auto lived = live(); !lived) return lived.error();
      vfs_.restart();
      ++report_.cycles;
      if (options_.on_cycle) options_.on_cycle();
    }
    if (auto lived = live(); !lived) return lived.error();  // looks at what the last crash left
    return report_;
  }

  Report total() const {
    Report total = report_;
    total.acknowledged += acknowledged_now_;
    total.snapshots = snapshots_now_;
    total.refused = refused_now_;
    return total;
  }

 private:
  /// From a restart to the next crash.
  Result<void> live() {
    auto log = comeBack();
    if (!log && !options_.synchronous) {  // without syncs a crash may leave anything, also what cannot be read
      startAgainFromNothing();
      log = comeBack();
    }
    if (!log) return log.error();

    vfs_.crashAfter(std::uniform_int_distribution<uint64_t>(1, kLongestRun)(random_));
    std::vector<std::thread> threads;
    for (auto& model : models_) {
      for (int writer = 0; writer < kWritersAWorld; ++writer)
        threads.emplace_back([&, m = model.get()] { write(*m, **log); });
      threads.emplace_back([&, m = model.get()] { writeSnapshots(*m, **log); });
    }
    for (std::thread& thread : threads) thread.join();
    vfs_.crashNow();
    return {};
  }

  Result<std::unique_ptr<EditLog>> comeBack() {
    auto log = open();
    if (!log) return log;
    for (auto& model : models_)
      if (auto looked = lookAt(*model, **log); !looked) return looked.error();
    return log;
  }

  Result<std::unique_ptr<EditLog>> open() {
    store::SqliteLogOptions options;
    options.folder = "/";
    options.vfs = vfs_.name();
    options.synchronous = options_.synchronous;
    options.checkpoint_pages = kCheckpointPages;
    options.group_window = std::chrono::milliseconds(1);
    return store::openSqliteEditLog(std::move(options));
  }

  /// Compares the log with the model, settles what was unknown, and lets the model go on from there.
  Result<void> lookAt(Model& model, EditLog& log) {
    const auto epoch = log.acquire(model.name);
    if (!epoch) return epoch.error();
    model.epoch = *epoch;
    const auto snapshot = log.snapshot(model.name);
    if (!snapshot) return snapshot.error();
    Content found;
    if (*snapshot) found = Content::restored((*snapshot)->bytes);
    model.snapshot_seq = found.requests.size();
    const auto records = log.read(model.name, found.requests.size(), SIZE_MAX);
    if (!records) return records.error();
    for (const auto& record : *records) {
      const bool whole = record.bytes == payload(record.request_id) && record.seq == found.requests.size() + 1;
      found.requests.push_back(whole ? record.request_id : "garbled");
    }
    count(model, found, log);
    model.content = std::move(found);
    for (const std::string& request : std::exchange(model.unknown, {})) settle(model, request, log);
    return {};
  }

  void count(Model& model, const Content& found, const EditLog& log) {
    std::unordered_map<std::string, uint64_t> times;
    for (const std::string& request : found.requests) report_.doubled += ++times[request] > 1;
    for (auto entry = model.acknowledged.begin(); entry != model.acknowledged.end();) {
      const auto& [request, seq] = *entry;
      const bool there = seq <= found.requests.size() && found.requests[seq - 1] == request;
      // The log counts its receipts itself: of those that were looked at before, a few are enough.
      const bool asked = seq > model.looked_at || random_() % 64 == 0;
      const bool remembered = !asked || log.find(model.name, request) == seq;
      const bool lost = !there || !remembered;
      report_.lost += lost;
      if (lost) entry = model.acknowledged.erase(entry);  // counted once
      else ++entry;
    }
    model.looked_at = found.requests.size();
  }

  /// What a client does that got no answer: the same request again. It must hold once, whether it had held or not.
  void settle(Model& model, const std::string& request, EditLog& log) {
    const uint64_t seq = model.content.requests.size() + 1;
    if (log.append(model.name, model.epoch, {seq, request, payload(request), request}) != Append::ok) return;
    const auto at = log.find(model.name, request);
    if (!at) return;
    if (*at == seq) model.content.requests.push_back(request);
    model.acknowledged[request] = *at;
    ++report_.settled;
    ++report_.acknowledged;
  }

  void write(Model& model, EditLog& log) {
    while (!vfs_.crashed()) {
      const std::lock_guard lock(model.mutex);
      const std::string request = model.name + "/" + std::to_string(model.next_request++);
      const uint64_t seq = model.content.requests.size() + 1;
      const Append answer = log.append(model.name, model.epoch, {seq, request, payload(request), request});
      if (answer == Append::ok) {
        model.content.requests.push_back(request);
        model.acknowledged[request] = seq;
        ++acknowledged_now_;
      } else {
        model.unknown.push_back(request);
        stop();
        return;
      }
    }
  }

  void writeSnapshots(Model& model, EditLog& log) {
    while (!vfs_.crashed()) {
      store::Snapshot snapshot;
      {
        const std::lock_guard lock(model.mutex);
        snapshot.seq = model.content.requests.size();
        if (snapshot.seq >= model.snapshot_seq + std::max(kSnapshotEvery, model.snapshot_seq / 4))
          snapshot.bytes = model.content.snapshot();
      }
      if (snapshot.bytes.empty()) {
        std::this_thread::sleep_for(std::chrono::microseconds(300));
        continue;
      }
      if (!log.putSnapshot(model.name, model.epoch, snapshot)) return stop();
      model.snapshot_seq = snapshot.seq;
      ++snapshots_now_;
      // Sometimes the crash shall find the records still there.
      if (snapshot.seq % 3 != 0 && !log.truncate(model.name, model.epoch, snapshot.seq)) return stop();
    }
  }

  /// What a server does whose log refuses: it ends. A log that syncs refuses after the crash alone; one without may
  /// come upon what an earlier crash has garbled at any time, and nobody would be left to bring the next crash about.
  void stop() {
    if (vfs_.crashed()) return;
    ++refused_now_;
    vfs_.crashNow();
  }

  void startAgainFromNothing() {
    ++report_.unreadable;
    for (auto& model : models_) {
      report_.lost += model->acknowledged.size();
      model->acknowledged.clear();
      model->unknown.clear();
      model->looked_at = 0;
    }
    vfs_.clear();
  }

  const Options& options_;
  ForgetfulVfs vfs_;
  std::mt19937_64 random_;
  std::vector<std::unique_ptr<Model>> models_;
  std::atomic<uint64_t> acknowledged_now_ = 0, snapshots_now_ = 0, refused_now_ = 0;
  Report report_;
};

}  // namespace

Result<Report> run(const Options& options) {
  const auto level = spdlog::get_level();
  spdlog::set_level(spdlog::level::off);  // every crash is an error that the log reports
  Run crashes(options);
  const auto done = crashes.run();
  spdlog::set_level(level);
  if (!done) return done.error();
  return crashes.total();
}

}  // namespace helio::crash
