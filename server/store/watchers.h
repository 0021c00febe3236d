// Calls back the watchers of one world, in order, without holding any lock of the log.
#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <vector>

#include "store/edit_log.h"

namespace helio::store {

using RecordPtr = std::shared_ptr<const Record>;

/// Two steps, because order is decided under the log's lock but callbacks must run outside of it: enqueue() while
/// holding that lock, then deliver() after it. Whoever finds nobody delivering delivers for everyone, so that calls
/// never overlap or overtake each other. Thread-safe.
class Watchers {
 public:
  /// Ends with the handle; see EditLog::watch. The handle may outlive this object.
  std::shared_ptr<void> add(std::function<void(const Record&)> on_record);

  /// Notes a record for all who watch at this moment.
  void enqueue(RecordPtr record);
  /// Calls back for what is enqueued, unless another thread (or a caller up this one's stack) is at it already.
  void deliver();

 private:
  struct Watcher {
    explicit Watcher(std::function<void(const Record&)> callback) : on_record(std::move(callback)) {}
    const std::function<void(const Record&)> on_record;
    std::recursive_mutex calling;  // held during calls; recursive, for a callback may drop its own handle
    bool stopped = false;
  };
  struct Delivery {
    RecordPtr record;
    std::vector<std::shared_ptr<Watcher>> to;
  };

  std::mutex mutex_;
  std::vector<std::weak_ptr<Watcher>> watchers_;
  std::deque<Delivery> queue_;
  bool delivering_ = false;
};

}  // namespace helio::store
