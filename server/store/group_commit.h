// Many writers, one transaction, one sync.
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "base/result.h"
#include "store/sqlite.h"

namespace helio::store {

/// Runs what writers bring in transactions of its own thread. Thread-safe.
class GroupCommit {
 public:
  /// `mutex` guards `database`, which is at `path` and outlives this object. The rest: see SqliteLogOptions.
  GroupCommit(Database& database, std::mutex& mutex, std::string path, std::chrono::milliseconds window,
              std::function<void(const Error&)> on_fatal);
  /// Commits what has been brought.
  ~GroupCommit();

  /// Runs `work` in the next transaction and returns when it is on disk; then `committed` has run, too, in the order of
  /// the transactions, under the mutex. Errors: nothing of the transaction holds, or, after a failure of the disk, it
  /// is not known whether it does.
  Result<void> write(const std::function<void()>& work, const std::function<void()>& committed);

 private:
  struct Job {
    const std::function<void()>* work;
    const std::function<void()>* committed;
    bool done = false;
    Result<void> result;
  };

  void run();
  Result<void> commit(const std::vector<Job*>& group);
  Result<void> fail(Error error, bool fatal);

  Database& database_;
  std::mutex& database_mutex_;
  const std::string path_;
  const std::chrono::milliseconds window_;
  const std::function<void(const Error&)> on_fatal_;
  // Own thread only:
  std::optional<Error> broken_;  // the failure after which nothing is written any more
  bool remains_ = false;         // the write-ahead log may have frames of a transaction that failed

  std::mutex mutex_;  // guards the rest
  std::condition_variable arrived_, done_;
  std::vector<Job*> waiting_;
  bool stopping_ = false;
  std::thread thread_;
};

}  // namespace helio::store
