#include "service/telemetry_service.h"

#include <grpcpp/alarm.h>

#include <algorithm>
#include <map>
#include <utility>

#include "service/convert.h"

namespace helio::service {
namespace {

/// A watched counter's growth since the last sample; the first sample starts from nothing.
struct Last {
  telemetry::WorldCounters world;
  std::map<uint64_t, telemetry::ViewerCounters> viewers;
  uint64_t edits = 0;
  double newest_edit_ms = 0;
};

void describe(const ViewerStatus& viewer, const telemetry::ViewerCounters& last, double seconds, Clock::time_point now,
              v1::ViewerTelemetry& out) {
  const auto& counters = viewer.counters;
  const uint64_t frames = counters.frames - last.frames;
  const auto mean = [&](uint64_t sum, uint64_t before) {
    return frames == 0 ? 0u : static_cast<uint32_t>((sum - before) / frames);
  };
  out.set_viewer(viewer.id);
  out.set_width(viewer.settings.width);
  out.set_height(viewer.settings.height);
  out.set_frames(counters.frames);
  out.set_dropped(counters.dropped);
  if (seconds > 0) {
    out.set_frames_per_second(static_cast<float>(double(frames) / seconds));
    out.set_bytes_per_second(static_cast<float>(double(counters.bytes - last.bytes) / seconds));
  }
  out.set_unacknowledged(viewer.unacknowledged);
  out.set_window(viewer.window);
  if (viewer.round_trip) out.set_round_trip_ms(static_cast<float>(telemetry::milliseconds(*viewer.round_trip)));
  if (viewer.last_acknowledged)
    out.set_acknowledgement_age_ms(static_cast<float>(telemetry::milliseconds(now - *viewer.last_acknowledged)));
  out.set_applied_seq(counters.newest.applied_seq);
  fillStats(counters.newest, out);
  toWire(counters.dropped_samples, *out.mutable_dropped_samples());
  out.set_camera_wait_us(mean(counters.sums.camera_wait, last.sums.camera_wait));
  out.set_tick_us(mean(counters.sums.tick, last.sums.tick));
  out.set_mailbox_us(mean(counters.sums.mailbox, last.sums.mailbox));
  out.set_encode_us(mean(counters.sums.encode, last.sums.encode));
  out.set_write_us(mean(counters.sums.write, last.sums.write));
}

void describe(HostedWorld& world, Last& last, double seconds, Clock::time_point now, v1::WorldTelemetry& out) {
  out.set_world(world.name());
  const auto content = world.content();
  if (!content) return;
  out.set_instances((*content)->instanceCount());
  out.set_seq((*content)->seq());
  out.set_checksum((*content)->checksum());

  const auto counters = world.counters();
  const uint64_t ticks = counters.ticks - last.world.ticks;
  out.set_ticks(counters.ticks);
  if (seconds > 0) out.set_ticks_per_second(static_cast<float>(double(ticks) / seconds));
  if (ticks > 0)
    out.set_tick_ms(static_cast<float>(double(counters.tick_us - last.world.tick_us) / 1000.0 / double(ticks)));
  last.world = counters;

  const auto [edits, index] = world.editLatency().since(last.edits);
  last.edits = index;
  if (!edits.empty()) {
    last.newest_edit_ms = edits.back();
    out.set_edit_to_picture_worst_ms(static_cast<float>(*std::max_element(edits.begin(), edits.end())));
  }
  out.set_edit_to_picture_ms(static_cast<float>(last.newest_edit_ms));

  std::map<uint64_t, telemetry::ViewerCounters> seen;
  for (const auto& viewer : world.viewerStatus()) {
    describe(viewer, last.viewers[viewer.id], seconds, now, *out.add_viewers());
    seen[viewer.id] = viewer.counters;
  }
  last.viewers = std::move(seen);
}

}  // namespace

/// One write or one alarm is under way at a time.
class TelemetryService::Watcher final : public grpc::ServerWriteReactor<v1::TelemetrySample> {
 public:
  Watcher(TelemetryService& service, grpc::CallbackServerContext& context, const v1::WatchTelemetryRequest& request)
      : service_(service), context_(context), world_(request.world()), interval_ms_(request.interval_ms()) {
    if (interval_ms_ == 0) interval_ms_ = 1000;
  }

  void start() {
    // The request's field `world` may be empty, for all that the caller may see.
    auto caller = service_.access_.admit(context_, "TelemetryService.Watch");
    if (caller && !world_.empty())
      if (auto allowed = AccessControl::checkWorld(*caller, world_); !allowed) caller = allowed.error();
    if (caller) {
      caller_ = *caller;
      session_ = service_.access_.enter(caller_, [this](const Failure& why, bool at_once) {
        if (at_once) context_.TryCancel();
        else end(why);
      });
    }
    std::lock_guard lock(mutex_);
    if (!caller) return finish(caller.error());
    if (interval_ms_ < 100 || interval_ms_ > 60'000)
      return finish(outOfRange("interval_ms", std::to_string(interval_ms_), "[100, 60000]"));
    sample();
  }

  void end(const Failure& why) {
    std::lock_guard lock(mutex_);
    ending_ = why;
    alarm_.Cancel();
  }

  void OnWriteDone(bool ok) override {
    std::lock_guard lock(mutex_);
    if (!ok || ending_ || cancelled_) return finish(ending_);
    alarm_.Set(std::chrono::system_clock::now() + std::chrono::milliseconds(interval_ms_), [this](bool) { expired(); });
  }

  void OnCancel() override {
    std::lock_guard lock(mutex_);
    cancelled_ = true;
    alarm_.Cancel();
  }

  void OnDone() override {
    // An alarm that finished the call is no reaction of it, and may not have let go of the lock.
    { const std::lock_guard lock(mutex_); }
    session_.reset();
    {
      std::lock_guard lock(service_.mutex_);
      service_.watchers_.erase(this);
    }
    delete this;
  }

 private:
  void expired() {
    std::lock_guard lock(mutex_);
    if (ending_ || cancelled_) return finish(ending_);
    sample();
  }

  void sample() {
    const auto now = Clock::now();
    const double seconds = last_sample_ ? std::chrono::duration<double>(now - *last_sample_).count() : 0;
    last_sample_ = now;
    out_.Clear();
    out_.set_uptime(std::chrono::duration<double>(now - service_.started_).count());
    out_.set_resident_bytes(telemetry::residentBytes());
    if (world_.empty()) {
      std::map<std::string, Last> seen;
      for (const auto& world : service_.worlds_.list()) {
        if (!caller_.mayUse(world->name())) continue;
        auto& last = seen[world->name()] = std::move(last_[world->name()]);
        describe(*world, last, seconds, now, *out_.add_worlds());
      }
      last_ = std::move(seen);
    } else {
      auto world = service_.worlds_.find(world_);
      if (!world) return finish(world.error());
      describe(**world, last_[world_], seconds, now, *out_.add_worlds());
    }
    StartWrite(&out_);
  }

  void finish(const std::optional<Failure>& why) {
    if (std::exchange(finished_, true)) return;
    Finish(why ? toStatus(*why, context_) : grpc::Status::OK);
  }

  TelemetryService& service_;
  grpc::CallbackServerContext& context_;
  const std::string world_;
  uint32_t interval_ms_;
  Caller caller_;
  AccessControl::Session session_;
  std::map<std::string, Last> last_;
  std::optional<Clock::time_point> last_sample_;
  v1::TelemetrySample out_;
  std::mutex mutex_;
  grpc::Alarm alarm_;
  std::optional<Failure> ending_;
  bool cancelled_ = false, finished_ = false;
};

grpc::ServerWriteReactor<v1::TelemetrySample>* TelemetryService::Watch(grpc::CallbackServerContext* context,
                                                                       const v1::WatchTelemetryRequest* request) {
  auto* watcher = new Watcher(*this, *context, *request);
  {
    std::lock_guard lock(mutex_);
    watchers_.insert(watcher);
    if (draining_) watcher->end(draining());
  }
  watcher->start();
  return watcher;
}

void TelemetryService::drain() {
  std::lock_guard lock(mutex_);
  draining_ = true;
  for (auto* watcher : watchers_) watcher->end(draining());
}

}  // namespace helio::service
