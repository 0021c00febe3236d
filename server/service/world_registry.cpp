#include "service/world_registry.h"

#include <spdlog/spdlog.h>

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

/// The source that a log's manifest names; if it names none, one whose loading fails with the reason.
WorldSource sourceOf(Result<std::string> bytes, const WorldRegistry::FindSource& find_source) {
  const auto failing = [](const Error& error, Manifest manifest) {
    return WorldSource{std::move(manifest), [error]() -> Result<scene::ScenePtr> { return error; }};
  };
  if (!bytes) return failing(bytes.error(), {Manifest::Gltf{"unknown"}, {}});
  auto manifest = decodeManifest(*bytes);
  if (!manifest) return failing(manifest.error(), {Manifest::Gltf{"unknown"}, {}});
  auto source = find_source(*manifest);
  if (!source) return failing(source.error().error, *manifest);
  return std::move(*source);
}

}  // namespace

WorldRegistry::WorldRegistry(WorldEnvironment environment, const Limits& limits)
    : environment_(std::move(environment)), limits_(limits) {}

WorldRegistry::~WorldRegistry() {
  drain();
  for (auto& [name, world] : worlds_) world->join();
  for (auto& world : dying_) world->join();
}

Result<void> WorldRegistry::restore(const FindSource& find_source) {
  const auto names = environment_.log->worlds();
  if (!names) return names.error();
  std::lock_guard lock(mutex_);
  for (const std::string& name : *names) {
    auto bytes = environment_.log->manifest(name);
    if (bytes && bytes->empty()) {  // the server ended while it was being made: nobody was told that it exists
      spdlog::info("world {}: was never complete, and is removed", name);
      if (auto removed = environment_.log->remove(name); !removed) return removed;
      continue;
    }
    if (worlds_.size() >= limits_.max_worlds)
      return Error{ErrorKind::limit,
                   fmt::format("the log holds {} worlds, this server allows {}", names->size(), limits_.max_worlds),
                   "max_worlds", std::to_string(names->size()), std::to_string(limits_.max_worlds)};
    worlds_[name] = std::make_shared<HostedWorld>(name, sourceOf(std::move(bytes), find_source), environment_);
    awaited_.push_back(worlds_[name]);
  }
  return {};
}

/// A name that is free, for a world that there is room for.
Outcome<void> WorldRegistry::reserve(std::string& name) {
  if (draining_) return draining();
  reap();
  const auto taken = [&](const std::string& n) { return worlds_.count(n) != 0 || entering_.count(n) != 0; };
  if (name.empty()) {
    do name = "world-" + std::to_string(++chosen_names_);
    while (taken(name));
  }
  if (!wellFormed(name, limits_.max_name_length))
    return outOfRange("world", fmt::format("\"{}\"", name.substr(0, 80)),
                      fmt::format("1 to {} of [a-z0-9._-], first a letter or digit", limits_.max_name_length));
  if (taken(name))
    return Failure{
        v1::ERROR_REASON_WORLD_EXISTS,
        {ErrorKind::conflict, "world \"" + name + "\" exists; choose another name or delete it", "world", name, {}}};
  if (leaving_.count(name) != 0 ||
      std::any_of(dying_.begin(), dying_.end(), [&](const WorldPtr& w) { return w->name() == name; }))
    return Failure{
        v1::ERROR_REASON_UNAVAILABLE,
        {ErrorKind::unavailable, "world \"" + name + "\" is still being deleted; try again", "world", name, {}},
        kDeletingRetryMs};
  const std::string most = std::to_string(limits_.max_worlds);
  if (worlds_.size() + entering_.size() + leaving_.size() + dying_.size() >= limits_.max_worlds)
    return beyondLimit("world", name, most, fmt::format("this server holds its {} worlds already; delete one", most));
  entering_.insert(name);
  return {};
}

Outcome<WorldPtr> WorldRegistry::create(std::string name, WorldSource source) {
  {
    std::lock_guard lock(mutex_);
    if (auto reserved = reserve(name); !reserved) return reserved.error();
  }
  const auto entered = enterIntoLog(*environment_.log, name, source.manifest);  // a disk's time: nobody else waits
  std::lock_guard lock(mutex_);
  entering_.erase(name);
  if (!entered) return Failure(entered.error());
  if (draining_) return draining();
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
  WorldPtr world;
  {
    std::lock_guard lock(mutex_);
    if (draining_) return draining();
    const auto found = worlds_.find(name);
    if (found == worlds_.end()) return unknownWorld(name);
    world = found->second;
    worlds_.erase(found);
    leaving_.insert(name);
  }
  world->stop(worldDeleted(name));
  const auto removed = environment_.log->remove(name);  // a disk's time: nobody else waits
  std::lock_guard lock(mutex_);
  leaving_.erase(name);
  dying_.push_back(std::move(world));
  reap();
  if (!removed && removed.error().kind != ErrorKind::not_found) return Failure(removed.error());
  return {};
}

Outcome<WorldRegistry::Repaired> WorldRegistry::repair(const std::string& name, uint64_t accept_loss) {
  const auto damaged = find(name);
  if (!damaged) return damaged.error();
  const auto content = (*damaged)->content();
  if (content || content.error().reason == v1::ERROR_REASON_WORLD_FAILED)
    return Failure{v1::ERROR_REASON_UNSUPPORTED,
                   {ErrorKind::unsupported,
                    "the log of world \"" + name + "\" is not damaged; there is nothing to repair",
                    "world",
                    name,
                    {}}};
  if (content.error().reason != v1::ERROR_REASON_DATA_LOSS) return content.error();  // being loaded, deleted

  const auto kept = environment_.log->repair(name, accept_loss);  // a disk's time: nobody else waits
  if (!kept && kept.error().kind == ErrorKind::conflict) return Failure{v1::ERROR_REASON_UNSUPPORTED, kept.error()};
  if (!kept) return Failure(kept.error());
  spdlog::warn("world {}: repaired up to seq {}: {} edits lost, {} requests forgotten", name, kept->last_seq,
               kept->lost, kept->forgotten_requests);

  std::lock_guard lock(mutex_);
  if (draining_) return draining();
  const auto entry = worlds_.find(name);
  if (entry == worlds_.end() || entry->second != *damaged) return unknownWorld(name);  // deleted meanwhile
  entry->second->stop(
      {v1::ERROR_REASON_WORLD_LOADING,
       {ErrorKind::unavailable, "world \"" + name + "\" has just been repaired; try again", "world", name, {}},
       kDeletingRetryMs});
  entry->second->join();  // it failed: its thread only waits for this
  entry->second = std::make_shared<HostedWorld>(name, (*damaged)->source(), environment_);
  return Repaired{entry->second, *kept};
}

/// Forgets the worlds whose threads have ended, and their logs.
void WorldRegistry::reap() {
  const auto ended = std::partition(dying_.begin(), dying_.end(), [](const WorldPtr& w) { return !w->stopped(); });
  for (auto i = ended; i != dying_.end(); ++i) {
    (*i)->join();
    // It may have been acquired again by a load that was in progress; a new world of the name must not find that.
    auto removed = environment_.log->remove((*i)->name());
    if (!removed && removed.error().kind != ErrorKind::not_found) environment_.on_fatal(removed.error());
  }
  dying_.erase(ended, dying_.end());
}

void WorldRegistry::await(const WorldPtr& world) {
  std::lock_guard lock(mutex_);
  awaited_.push_back(world);
}

bool WorldRegistry::started() const {
  std::lock_guard lock(mutex_);
  std::erase_if(awaited_, [](const std::weak_ptr<HostedWorld>& weak) {
    const auto world = weak.lock();
    return !world || world->state() != HostedWorld::State::loading;
  });
  return awaited_.empty();
}

Outcome<ViewerPlace> WorldRegistry::admitViewer(bool returning) {
  {
    std::lock_guard lock(mutex_);
    if (draining_) return draining();
  }
  const std::string most = std::to_string(limits_.max_viewers);
  if (!returning && *viewers_ >= limits_.max_viewers)
    for (const auto& world : list()) world->forgetWaiting();
  if (viewers_->fetch_add(1) >= limits_.max_viewers && !returning) {
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
