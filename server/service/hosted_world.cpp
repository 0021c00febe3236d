#include "service/hosted_world.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <unordered_map>
#include <utility>

namespace helio::service {
namespace {

// Viewers whose next frames are due within this time share a tick: the world's own passes are paid once.
constexpr auto kShareTick = std::chrono::milliseconds(4);
// Loading a city of 10,000 instances takes about so long; clients poll at this pace.
constexpr uint32_t kLoadingRetryMs = 250;

/// `newer` on top of `older`, as one change set.
world::ChangeSet merge(world::ChangeSet older, world::ChangeSet newer) {
  std::unordered_map<uint32_t, size_t> where;
  for (size_t i = 0; i < older.slots.size(); ++i) where[older.slots[i].slot] = i;
  for (auto& slot : newer.slots) {
    if (const auto found = where.find(slot.slot); found != where.end()) older.slots[found->second] = std::move(slot);
    else older.slots.push_back(std::move(slot));
  }
  newer.slots = std::move(older.slots);
  newer.environment_changed |= older.environment_changed;
  return newer;
}

}  // namespace

HostedWorld::HostedWorld(std::string name, WorldSource source, const WorldEnvironment& environment)
    : name_(std::move(name)),
      source_(std::move(source)),
      environment_(environment),
      log_(name_, *environment_.log, environment_.snapshot_bytes, environment_.on_fatal),
      thread_([this] { run(); }) {}

HostedWorld::~HostedWorld() = default;

void HostedWorld::join() {
  if (thread_.joinable()) thread_.join();
}

// ---- What callers see
// ------------------------------------------------------------------------------------------------

HostedWorld::State HostedWorld::state() const {
  std::lock_guard lock(mutex_);
  return state_;
}

std::string HostedWorld::error() const {
  std::lock_guard lock(mutex_);
  return error_.message;
}

Outcome<world::World*> HostedWorld::content() {
  std::lock_guard lock(mutex_);
  if (stop_reason_) return *stop_reason_;
  if (state_ == State::loading)
    return Failure{
        v1::ERROR_REASON_WORLD_LOADING,
        {ErrorKind::unavailable, "world \"" + name_ + "\" is still being loaded; try again", "world", name_, {}},
        kLoadingRetryMs};
  if (state_ == State::failed) {
    const bool damaged = error_.kind == ErrorKind::damaged;
    return Failure{damaged ? v1::ERROR_REASON_DATA_LOSS : v1::ERROR_REASON_WORLD_FAILED,
                   {damaged ? ErrorKind::damaged : ErrorKind::unsupported,
                    "world \"" + name_ + "\" could not be loaded: " + error_.message,
                    "world",
                    name_,
                    {}}};
  }
  return content_.get();
}

Outcome<const world::World*> HostedWorld::content() const {
  auto content = const_cast<HostedWorld*>(this)->content();
  if (!content) return content.error();
  return static_cast<const world::World*>(*content);
}

Outcome<void> HostedWorld::attach(std::shared_ptr<ViewSink> sink) {
  if (auto ready = content(); !ready) return ready.error();
  std::lock_guard lock(mutex_);
  if (stop_reason_) return *stop_reason_;
  views_.push_back(std::make_shared<View>(View{std::move(sink), std::nullopt}));
  woken_ = true;
  wake_.notify_all();
  return {};
}

void HostedWorld::detach(const ViewSink* sink) {
  std::lock_guard lock(mutex_);
  const auto view = std::find_if(views_.begin(), views_.end(), [&](const auto& v) { return v->sink.get() == sink; });
  if (view == views_.end()) return;
  leaving_.push_back(*view);
  views_.erase(view);
  woken_ = true;
  wake_.notify_all();
}

void HostedWorld::wake() {
  std::lock_guard lock(mutex_);
  woken_ = true;
  wake_.notify_all();
}

void HostedWorld::stop(const Failure& why) {
  {
    std::lock_guard lock(mutex_);
    if (stop_reason_) return;
    stop_reason_ = why;
    woken_ = true;
    wake_.notify_all();
  }
  endAll(why);  // at once: a tick in progress may take seconds
}

bool HostedWorld::stopped() const {
  std::lock_guard lock(mutex_);
  return stopped_;
}

uint32_t HostedWorld::viewers() const {
  std::lock_guard lock(mutex_);
  return static_cast<uint32_t>(views_.size());
}

std::vector<ViewerStatus> HostedWorld::viewerStatus() const {
  Views views;
  {
    std::lock_guard lock(mutex_);
    views = views_;
  }
  std::vector<ViewerStatus> out;
  for (const auto& view : views)
    if (auto status = view->sink->status()) out.push_back(std::move(*status));
  return out;
}

telemetry::WorldCounters HostedWorld::counters() const {
  std::lock_guard lock(mutex_);
  return counters_;
}

// ---- Edits
// -----------------------------------------------------------------------------------------------------------

Outcome<EditAnswer> HostedWorld::apply(const EditRequest& request, Clock::time_point arrived) {
  auto content = this->content();
  if (!content) return content.error();
  auto applied = log_.apply(**content, request);
  if (!applied) {
    if (auto still = this->content(); !still) return still.error();  // it was deleted meanwhile, which says more
    return applied;
  }
  if (!applied->replayed) {
    edit_latency_.arrived(applied->seq, arrived);
    wake();
  }
  return applied;
}

// ---- The world's thread
// ----------------------------------------------------------------------------------------------

void HostedWorld::run() {
  if (auto loaded = load(); loaded) {
    tickUntilStopped();
  } else {
    spdlog::error("world {}: {}", name_, loaded.error().message);
    std::unique_lock lock(mutex_);
    state_ = State::failed;
    error_ = loaded.error();
    wake_.wait(lock, [&] { return stop_reason_.has_value(); });
  }
  std::lock_guard lock(mutex_);
  stopped_ = true;
}

Result<void> HostedWorld::load() {
  auto scene = source_.load();
  if (!scene) return scene.error();
  auto handle = environment_.renderer->addWorld(*scene);
  if (!handle) return handle.error();
  handle_ = *handle;
  auto content = log_.load(*scene, source_, environment_.limits);
  if (!content) {
    environment_.renderer->removeWorld(handle_);
    return content.error();
  }
  const uint64_t instances = (*content)->instanceCount(), seq = (*content)->seq();
  {
    std::lock_guard lock(mutex_);
    content_ = std::move(*content);
    last_tick_ = Clock::now();
    state_ = State::ready;
  }
  spdlog::info("world {}: ready at seq {}, {} instances ({})", name_, seq, instances, source_.description());
  return {};
}

void HostedWorld::tickUntilStopped() {
  for (;;) {
    const Views wanted = waitForDemand();
    if (wanted.empty()) break;
    tick(wanted);
  }
  Failure why;
  {
    std::lock_guard lock(mutex_);
    why = *stop_reason_;
  }
  endAll(why);  // whatever stop() has not come to yet
  admitAndRelease();
  environment_.renderer->removeWorld(handle_);
}

/// Frees the views of who left and makes those of who came.
void HostedWorld::admitAndRelease() {
  Views leaving, attached;
  {
    std::lock_guard lock(mutex_);
    leaving.swap(leaving_);
    attached = views_;
  }
  for (const auto& view : leaving)
    if (view->handle) environment_.renderer->removeView(*view->handle);
  for (const auto& view : attached) {
    if (view->handle) continue;
    auto handle = environment_.renderer->addView(handle_);
    if (handle) {
      view->handle = *handle;
    } else {
      view->sink->end(handle.error());
      detach(view->sink.get());
    }
  }
}

/// Sleeps until frames are wanted; returns whose. Empty: stop.
HostedWorld::Views HostedWorld::waitForDemand() {
  for (;;) {
    admitAndRelease();
    Views attached;
    {
      std::lock_guard lock(mutex_);
      if (stop_reason_) return {};
      woken_ = false;
      attached = views_;
    }
    const auto now = Clock::now();
    auto earliest = Clock::time_point::max();
    std::vector<std::pair<Clock::time_point, std::shared_ptr<View>>> due;
    for (const auto& view : attached) {
      if (!view->handle) continue;
      if (const auto from = view->sink->wantedFrom(now)) {
        earliest = std::min(earliest, *from);
        due.emplace_back(*from, view);
      }
    }
    if (earliest <= now) {
      Views wanted;
      for (const auto& [from, view] : due)
        if (from <= now + kShareTick) wanted.push_back(view);
      return wanted;
    }
    std::unique_lock lock(mutex_);
    const auto changed = [&] { return woken_ || stop_reason_; };
    if (earliest == Clock::time_point::max()) wake_.wait(lock, changed);
    else wake_.wait_until(lock, earliest, changed);
  }
}

void HostedWorld::tick(const Views& wanted) {
  // The clock goes on by real time, however long nobody looked.
  const auto now = Clock::now();
  auto changes = content_->beginTick(std::chrono::duration<double>(now - last_tick_).count());
  last_tick_ = now;
  if (unrendered_) changes = merge(std::move(*std::exchange(unrendered_, std::nullopt)), std::move(changes));

  if (auto rendered = render(changes, wanted); !rendered) {
    if (rendered.error().kind == ErrorKind::internal) {
      endAll(rendered.error());
      environment_.on_fatal(rendered.error());
    } else if (wanted.size() == 1) {
      wanted.front()->sink->end(rendered.error());
      detach(wanted.front()->sink.get());
    } else {
      renderEach(changes, wanted);
    }
    unrendered_ = std::move(changes);  // whole slots: applying them again does no harm
  }
}

Result<void> HostedWorld::render(const world::ChangeSet& changes, const Views& wanted) {
  const auto start = Clock::now();
  std::vector<render::ViewRequest> requests;
  for (const auto& view : wanted) {
    auto demand = view->sink->demand(start);
    requests.push_back({*view->handle, demand.camera, demand.settings});
  }
  auto frames = environment_.renderer->tick(handle_, changes, requests);
  if (!frames) return frames.error();
  const auto took = Clock::now() - start;
  {
    std::lock_guard lock(mutex_);
    ++counters_.ticks;
    counters_.tick_us += telemetry::microseconds(took);
  }
  for (size_t i = 0; i < wanted.size(); ++i) wanted[i]->sink->deliver(std::move((*frames)[i]), took);
  return {};
}

/// One view spoilt the tick of all: find it, and let the others have their frames.
void HostedWorld::renderEach(const world::ChangeSet& changes, const Views& wanted) {
  for (const auto& view : wanted)
    if (auto rendered = render(changes, {view}); !rendered) {
      view->sink->end(rendered.error());
      detach(view->sink.get());
    }
}

void HostedWorld::endAll(const Failure& why) {
  Views ending;
  {
    std::lock_guard lock(mutex_);
    ending.swap(views_);
    leaving_.insert(leaving_.end(), ending.begin(), ending.end());
  }
  for (const auto& view : ending) view->sink->end(why);
}

}  // namespace helio::service
