#include "store/watchers.h"

#include <algorithm>
#include <utility>

namespace helio::store {

std::shared_ptr<void> Watchers::add(std::function<void(const Record&)> on_record) {
  auto watcher = std::make_shared<Watcher>(std::move(on_record));
  {
    const std::lock_guard lock(mutex_);
    watchers_.push_back(watcher);
  }
  // The handle owns the watcher; its end waits for a running call of another thread and lets none begin.
  Watcher* const watched = watcher.get();
  return {watched, [watcher = std::move(watcher)](void*) {
            const std::lock_guard lock(watcher->calling);
            watcher->stopped = true;
          }};
}

void Watchers::enqueue(RecordPtr record) {
  const std::lock_guard lock(mutex_);
  Delivery delivery{std::move(record), {}};
  watchers_.erase(std::remove_if(watchers_.begin(), watchers_.end(), [](const auto& w) { return w.expired(); }),
                  watchers_.end());
  for (const std::weak_ptr<Watcher>& watcher : watchers_) {
    if (auto alive = watcher.lock()) delivery.to.push_back(std::move(alive));
  }
  if (!delivery.to.empty()) queue_.push_back(std::move(delivery));
}

void Watchers::deliver() {
  std::unique_lock lock(mutex_);
  if (delivering_) return;
  delivering_ = true;
  while (!queue_.empty()) {
    const Delivery delivery = std::move(queue_.front());
    queue_.pop_front();
    lock.unlock();
    for (const std::shared_ptr<Watcher>& watcher : delivery.to) {
      const std::lock_guard calling(watcher->calling);
      if (!watcher->stopped) watcher->on_record(*delivery.record);
    }
    lock.lock();
  }
  delivering_ = false;
}

}  // namespace helio::store
