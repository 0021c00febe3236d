#include "store/group_commit.h"

#include <spdlog/spdlog.h>

#include <utility>

namespace helio::store {

GroupCommit::GroupCommit(Database& database, std::mutex& mutex, std::string path, std::chrono::milliseconds window,
                         std::function<void(const Error&)> on_fatal)
    : database_(database),
      database_mutex_(mutex),
      path_(std::move(path)),
      window_(window),
      on_fatal_(std::move(on_fatal)),
      thread_([this] { run(); }) {}

GroupCommit::~GroupCommit() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
    arrived_.notify_all();
  }
  thread_.join();
}

Result<void> GroupCommit::write(const std::function<void()>& work, const std::function<void()>& committed) {
  Job job{&work, &committed, false, {}};
  std::unique_lock lock(mutex_);
  waiting_.push_back(&job);
  arrived_.notify_all();
  done_.wait(lock, [&] { return job.done; });
  return job.result;
}

void GroupCommit::run() {
  size_t last_group = 1;
  std::unique_lock lock(mutex_);
  for (;;) {
    arrived_.wait(lock, [&] { return stopping_ || !waiting_.empty(); });
    if (waiting_.empty()) return;
    // Who came to the last transaction is probably on the way again.
    arrived_.wait_for(lock, window_, [&] { return stopping_ || waiting_.size() >= last_group; });
    const std::vector<Job*> group = std::exchange(waiting_, {});
    last_group = group.size();

    lock.unlock();
    const Result<void> result = commit(group);
    lock.lock();
    for (Job* job : group) {
      job->result = result;
      job->done = true;
    }
    done_.notify_all();
  }
}

Result<void> GroupCommit::commit(const std::vector<Job*>& group) {
  if (broken_) return *broken_;
  const std::lock_guard lock(database_mutex_);
  try {
    if (std::exchange(remains_, false)) database_.emptyWal();
    database_.execute("BEGIN IMMEDIATE");
    for (const Job* job : group) (*job->work)();
    database_.execute("COMMIT");
  } catch (const SqliteFailure& failure) {
    database_.rollBack();
    remains_ = true;
    return fail(toError(failure, path_), !failure.diskFull());
  }
  for (const Job* job : group) (*job->committed)();
  return {};
}

// After a failed sync nobody knows what is on the disk, and a second sync may succeed without having written it: the
// way back is to start again from what can be read. A full disk is different, for there nothing was written.
Result<void> GroupCommit::fail(Error error, bool fatal) {
  spdlog::error("{}", error.message);
  if (fatal) {
    broken_ = error;
    if (on_fatal_) on_fatal_(error);
  }
  return error;
}

}  // namespace helio::store
