#include "service/world_registry.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <utility>

namespace helio::service {
namespace {

bool wellFormed(const std::string& name, uint32_t max_length) {
  const auto alphanumeric = [](char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9'); };
  if (name.empty() || name.size() > max_length || !alphanumeric(name.front())) return false;
  return std::all_of(name.begin(), name.end(),
                     [&](char c) { return alphanumeric(c) || c == '.' || c == '_' || c == '-'; });
}

constexpr uint32_t kDeletingRetryMs = 250;  // a tick or a load in progress has to end first

}  // namespace

WorldRegistry::WorldRegistry(WorldEnvironment environment, const Limits& limits)
    : environment_(std::move(environment)), limits_(limits) {}

WorldRegistry::~WorldRegistry() {
  drain();
  for (auto& [name, world] : worlds_) world->join();
  for (auto& world : dying_) world->join();
}

Outcome<WorldPtr> WorldRegistry::create(std::string name, WorldSource source) {
  std::lock_guard lock(mutex_);
  if (draining_) return draining();
  reap();
  if (name.empty()) {
    do name = "world-" + std::to_string(++chosen_names_);
    while (worlds_.count(name));
  }
  if (!wellFormed(name, limits_.max_name_length))
    return outOfRange("world", fmt::format("\"{}\"", name.substr(0, 80)),
                      fmt::format("1 to {} of [a-z0-9._-], first a letter or digit", limits_.max_name_length));
  if (worlds_.count(name))
    return Failure{
        v1::ERROR_REASON_WORLD_EXISTS,
        {ErrorKind::conflict, "world \"" + name + "\" exists; choose another name or delete it", "world", name, {}}};
  if (std::any_of(dying_.begin(), dying_.end(), [&](const WorldPtr& w) { return w->name() == name; }))
    return Failure{
        v1::ERROR_REASON_UNAVAILABLE,
        {ErrorKind::unavailable, "world \"" + name + "\" is still being deleted; try again", "world", name, {}},
        kDeletingRetryMs};
  const std::string most = std::to_string(limits_.max_worlds);
  if (worlds_.size() + dying_.size() >= limits_.max_worlds)
    return beyondLimit("world", name, most, fmt::format("this server holds its {} worlds already; delete one", most));
  return worlds_[name] = std::make_shared<HostedWorld>(name, std::move(source), environment_);
}

Outcome<WorldPtr> WorldRegistry::find(const std::string& name) const {
  std::lock_guard lock(mutex_);
  if (draining_) return draining();
  const auto found = worlds_.find(name);
  if (found == worlds_.end()) return unknownWorld(name);
  return found->second;
}

std::vector<WorldPtr> WorldRegistry::list(const std::string& after) const {
  std::lock_guard lock(mutex_);
  std::vector<WorldPtr> out;
  for (auto i = worlds_.upper_bound(after); i != worlds_.end(); ++i) out.push_back(i->second);
  return out;
}

Outcome<void> WorldRegistry::remove(const std::string& name) {
  std::lock_guard lock(mutex_);
  if (draining_) return draining();
  const auto found = worlds_.find(name);
  if (found == worlds_.end()) return unknownWorld(name);
  found->second->stop(worldDeleted(name));
  dying_.push_back(found->second);
  worlds_.erase(found);
  reap();
  return {};
}

/// Forgets the worlds whose threads have ended, and their logs.
void WorldRegistry::reap() {
  const auto ended = std::partition(dying_.begin(), dying_.end(), [](const WorldPtr& w) { return !w->stopped(); });
  for (auto i = ended; i != dying_.end(); ++i) {
    (*i)->join();
    // A new world of the name must not find the old one's records. (A world that failed to load has no log.)
    auto removed = environment_.log->remove((*i)->name());
    if (!removed && removed.error().kind != ErrorKind::not_found) environment_.on_fatal(removed.error());
  }
  dying_.erase(ended, dying_.end());
}

Outcome<ViewerPlace> WorldRegistry::admitViewer() {
  {
    std::lock_guard lock(mutex_);
    if (draining_) return draining();
  }
  const std::string most = std::to_string(limits_.max_viewers);
  if (viewers_->fetch_add(1) >= limits_.max_viewers) {
    viewers_->fetch_sub(1);
    return beyondLimit("viewers", most, most, "this server serves its " + most + " viewers already; try again later");
  }
  return ViewerPlace(viewers_.get(), [viewers = viewers_](void*) { viewers->fetch_sub(1); });
}

void WorldRegistry::drain() {
  std::lock_guard lock(mutex_);
  draining_ = true;
  for (auto& [name, world] : worlds_) world->stop(draining());
}

}  // namespace helio::service
