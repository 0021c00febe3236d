#include "service/hosted_world.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <functional>
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
      edit_rate_(environment_.max_edits_per_second),
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
    return Failure{
        damaged ? v1::ERROR_REASON_DATA_LOSS : v1::ERROR_REASON_WORLD_FAILED,
        {damaged ? ErrorKind::damaged : ErrorKind::unsupported,
         "world \"" + name_ + "\" could not be loaded: " + error_.message +
             (damaged ? "; or give up what cannot be read: helio worlds repair " + name_ + " --accept-loss N" : ""),
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

Outcome<bool> HostedWorld::attach(std::shared_ptr<ViewSink> sink, const std::string& key) {
  if (auto ready = content(); !ready) return ready.error();
  std::shared_ptr<View> before;
  std::shared_ptr<ViewSink> ghost;
  {
    std::lock_guard lock(mutex_);
    if (stop_reason_) return *stop_reason_;
    if (!key.empty()) {
      const auto alive = std::find_if(views_.begin(), views_.end(), [&](const auto& v) { return v->key == key; });
      const auto waiting =
          std::find_if(waiting_.begin(), waiting_.end(), [&](const Waiting& w) { return w.view->key == key; });
      if (alive != views_.end()) {
        before = *alive;
        ghost = before->sink;
        views_.erase(alive);
      } else if (waiting != waiting_.end()) {
        before = waiting->view;
        waiting_.erase(waiting);
      }
    }
    views_.push_back(std::make_shared<View>(View{std::move(sink), key, before, std::nullopt}));
    woken_ = true;
    wake_.notify_all();
  }
  if (ghost) ghost->end(superseded());
  return before != nullptr;
}

void HostedWorld::detach(const ViewSink* sink, std::chrono::seconds keep, std::shared_ptr<void> place) {
  std::lock_guard lock(mutex_);
  const auto view = std::find_if(views_.begin(), views_.end(), [&](const auto& v) { return v->sink.get() == sink; });
  if (view == views_.end()) return;
  if (keep.count() > 0 && !(*view)->key.empty() && !stop_reason_) {
    // An heir without a sink: the tick in progress may still use the view's own.
    waiting_.push_back({std::make_shared<View>(View{nullptr, (*view)->key, *view, std::nullopt}), Clock::now() + keep,
                        std::move(place)});
  } else {
    leaving_.push_back(*view);
  }
  views_.erase(view);
  woken_ = true;
  wake_.notify_all();
}

bool HostedWorld::knows(const std::string& key) const {
  std::lock_guard lock(mutex_);
  return std::any_of(views_.begin(), views_.end(), [&](const auto& v) { return v->key == key; }) ||
         std::any_of(waiting_.begin(), waiting_.end(), [&](const auto& w) { return w.view->key == key; });
}

void HostedWorld::forget(const std::string& key) {
  std::lock_guard lock(mutex_);
  const auto waiting =
      std::find_if(waiting_.begin(), waiting_.end(), [&](const auto& w) { return w.view->key == key; });
  if (waiting == waiting_.end()) return;
  leaving_.push_back(waiting->view);
  waiting_.erase(waiting);
  woken_ = true;
  wake_.notify_all();
}

size_t HostedWorld::forgetWaiting() {
  std::lock_guard lock(mutex_);
  const size_t count = waiting_.size();
  for (auto& waiting : waiting_) leaving_.push_back(std::move(waiting.view));
  waiting_.clear();
  woken_ = true;
  wake_.notify_all();
  return count;
}

void HostedWorld::tend(Clock::time_point now) {
  Views attached;
  {
    std::lock_guard lock(mutex_);
    attached = views_;
    const auto late =
        std::stable_partition(waiting_.begin(), waiting_.end(), [&](const Waiting& w) { return now < w.until; });
    if (late != waiting_.end()) {
      for (auto w = late; w != waiting_.end(); ++w) leaving_.push_back(std::move(w->view));
      waiting_.erase(late, waiting_.end());
      woken_ = true;
      wake_.notify_all();
    }
  }
  for (const auto& view : attached) view->sink->tend(now);
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
    idle_.notify_all();
  }
  endAll(why);  // at once: a tick in progress may take seconds
}

bool HostedWorld::stopped() const {
  std::lock_guard lock(mutex_);
  return stopped_;
}

bool HostedWorld::capture(uint64_t viewer, Capture capture) {
  Views views;
  {
    std::lock_guard lock(mutex_);
    views = views_;
  }
  for (const auto& view : views)
    if (const auto status = view->sink->status(); status && status->id == viewer)
      return view->sink->captureNext(std::move(capture));
  return false;
}

std::shared_ptr<void> HostedWorld::admitAside() {
  std::lock_guard lock(mutex_);
  if (!aside_.expired()) return nullptr;
  const auto right = std::make_shared<char>();
  aside_ = right;
  return right;
}

void HostedWorld::awaitIdle(Clock::duration needed, Clock::time_point until) {
  std::unique_lock lock(mutex_);
  idle_.wait_until(lock, until, [&] { return stop_reason_ || idle_until_ > Clock::now() + needed; });
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
  const uint64_t size = sizeOf(request.edits);
  if (auto wait = edit_rate_.take(size, arrived); wait.count() > 0) {
    environment_.metrics->rate_limited.Increment();
    const std::string most = std::to_string(environment_.max_edits_per_second);
    Failure failure =
        beyondLimit("edits", std::to_string(size), most,
                    "world \"" + name_ + "\" takes " + most + " edits and placements a second; try again in " +
                        std::to_string(wait.count()) + " ms");
    failure.retry_after_ms = static_cast<uint32_t>(wait.count());
    return failure;
  }
  auto applied = log_.apply(**content, request);
  if (!applied) {
    if (auto still = this->content(); !still) return still.error();  // it was deleted meanwhile, which says more
    if (applied.error().reason == v1::ERROR_REASON_FENCED)
      stop(applied.error());  // what is shown here is not the truth
    return applied;
  }
  if (!applied->replayed) {
    edit_latency_.arrived(applied->seq, arrived);
    environment_.metrics->edits.Increment(static_cast<double>(size));
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
  for (const auto& view : attached) inherit(*view);
  for (const auto& view : leaving) {
    inherit(*view);
    if (view->handle) environment_.renderer->removeView(*std::exchange(view->handle, std::nullopt));
  }
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

/// Takes over the handle of whom it comes after, along the whole line: nobody else needs it any more.
void HostedWorld::inherit(View& heir) {
  if (!heir.heir_of) return;
  inherit(*heir.heir_of);
  heir.handle = std::exchange(heir.heir_of->handle, std::nullopt);
  heir.heir_of.reset();
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
    idle_until_ = earliest;
    idle_.notify_all();
    if (earliest == Clock::time_point::max()) wake_.wait(lock, changed);
    else wake_.wait_until(lock, earliest, changed);
    idle_until_ = Clock::time_point::min();
  }
}

void HostedWorld::tick(const Views& wanted) {
  const auto now = Clock::now();
  Dues dues;
  bool captures = false;
  for (const auto& view : wanted) {
    dues.push_back({view, view->sink->demand(now)});
    auto& demand = dues.back().demand;
    captures |= demand.capture != nullptr;
    demand.settings.keep_radiance |= demand.capture != nullptr;
  }
  // The clock goes on by real time, however long nobody looked.
  world::ChangeSet whole;
  auto changes =
      content_->beginTick(std::chrono::duration<double>(now - last_tick_).count(), captures ? &whole : nullptr);
  last_tick_ = now;
  if (unrendered_) changes = merge(std::move(*std::exchange(unrendered_, std::nullopt)), std::move(changes));

  if (auto rendered = render(changes, whole, dues); !rendered) {
    if (rendered.error().kind == ErrorKind::internal) {
      endAll(rendered.error());
      environment_.on_fatal(rendered.error());
    } else if (wanted.size() == 1) {
      wanted.front()->sink->end(rendered.error());
      detach(wanted.front()->sink.get());
    } else {
      renderEach(changes, whole, dues);
    }
    unrendered_ = std::move(changes);  // whole slots: applying them again does no harm
  }
}

Result<void> HostedWorld::render(const world::ChangeSet& changes, const world::ChangeSet& whole, const Dues& dues) {
  const auto start = Clock::now();
  std::vector<render::ViewRequest> requests;
  for (const auto& [view, demand] : dues) requests.push_back({*view->handle, demand.camera, demand.settings});
  auto frames = environment_.renderer->tick(handle_, changes, requests);
  if (!frames) return frames.error();
  const auto took = Clock::now() - start;
  {
    std::lock_guard lock(mutex_);
    ++counters_.ticks;
    counters_.tick_us += telemetry::microseconds(took);
  }
  environment_.metrics->tick.Observe(std::chrono::duration<double>(took).count());
  for (size_t i = 0; i < dues.size(); ++i) {
    auto& frame = (*frames)[i];
    const auto& demand = dues[i].demand;
    if (demand.capture) demand.capture({frame, demand.camera, demand.settings, content_->scenePtr(), whole});
    dues[i].view->sink->deliver(std::move(frame), took);
  }
  return {};
}

/// One view spoilt the tick of all: find it, and let the others have their frames.
void HostedWorld::renderEach(const world::ChangeSet& changes, const world::ChangeSet& whole, const Dues& dues) {
  for (const auto& due : dues)
    if (auto rendered = render(changes, whole, {due}); !rendered) {
      due.view->sink->end(rendered.error());
      detach(due.view->sink.get());
    }
}

void HostedWorld::endAll(const Failure& why) {
  Views ending;
  {
    std::lock_guard lock(mutex_);
    ending.swap(views_);
    leaving_.insert(leaving_.end(), ending.begin(), ending.end());
    for (auto& waiting : waiting_) leaving_.push_back(std::move(waiting.view));
    waiting_.clear();
  }
  for (const auto& view : ending) view->sink->end(why);
}

}  // namespace helio::service
