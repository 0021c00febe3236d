#include "service/shot.h"

#include <algorithm>
#include <utility>

#include "service/viewpoint.h"
#include "stream/picture.h"

namespace helio::service {
namespace {

constexpr size_t kChunkBytes = 256 << 10;  // well below every message limit, large enough that framing costs nothing
constexpr uint32_t kSamplesPerTick = 4;    // a tick stays short: viewers of the same world wait for it

}  // namespace

Shot* Shot::open(const StreamEnvironment& environment, grpc::CallbackServerContext& context,
                 const v1::RenderRequest& request) {
  std::shared_ptr<Shot> shot(new Shot(environment, context));
  shot->self_ = shot;
  if (auto begun = shot->begin(request); !begun) shot->end(begun.error());
  return shot.get();
}

Shot::Shot(const StreamEnvironment& environment, grpc::CallbackServerContext& context)
    : environment_(environment), context_(context) {}

Outcome<void> Shot::begin(const v1::RenderRequest& request) {
  const auto caller = environment_.access->admit(context_, "RenderService.Render", request);
  if (!caller) return caller.error();
  auto world = environment_.worlds->find(request.world());
  if (!world) return world.error();
  auto content = (*world)->content();
  if (!content) return content.error();
  auto settings = fromWire(request, *environment_.limits);
  if (!settings) return settings.error();
  settings_ = *settings;
  settings_.view.samples = std::min(settings_.samples, kSamplesPerTick);

  auto camera = viewpointOf(request, (*content)->scene(), *environment_.limits);
  if (!camera) return camera.error();
  camera_ = *camera;
  auto place = environment_.worlds->admitViewer();
  if (!place) return place.error();
  place_ = *place;
  world_ = *world;
  session_ = environment_.access->enter(*caller, [weak = weak_from_this()](const Failure& why, bool at_once) {
    const auto shot = weak.lock();
    if (!shot) return;
    if (at_once) return shot->context_.TryCancel();
    shot->leave();
    shot->end(why);
  });
  auto attached = world_->attach(shared_from_this());
  if (!attached) return attached.error();
  return {};
}

std::optional<Clock::time_point> Shot::wantedFrom(Clock::time_point now) {
  std::lock_guard lock(mutex_);
  if (rendered_ || ending_ || gone_) return std::nullopt;
  return now;
}

ViewDemand Shot::demand(Clock::time_point) { return {camera_, settings_.view}; }

void Shot::deliver(render::Frame frame, Clock::duration) {
  std::unique_lock lock(mutex_);
  if (ending_ || gone_) return;
  const auto& stats = frame.stats;
  ++ticks_;
  gpu_ms_ += stats.gpu_ms;
  rays_.primary += stats.rays.primary;
  rays_.bounce += stats.rays.bounce;
  rays_.shadow += stats.rays.shadow;
  rays_.retrace += stats.rays.retrace;
  auto& progress = *progress_.emplace().mutable_progress();
  progress.set_samples(std::min(stats.accumulated, settings_.samples));
  progress.set_wanted(settings_.samples);
  // Edits start the samples again. A world that never rests gets a picture all the same, which says how good it is.
  const uint32_t enough = 2 * (settings_.samples / settings_.view.samples) + 8;
  rendered_ = stats.accumulated >= settings_.samples || ticks_ >= enough;
  if (rendered_)
    environment_.encoders->submit(
        [self = shared_from_this(), shared = std::make_shared<render::Frame>(std::move(frame))](
            stream::JpegEncoder& encoder) { self->encode(encoder, std::move(*shared)); });
  pump();
  lock.unlock();
  if (rendered_) world_->detach(this);
}

/// On a thread of the pool, without the lock.
void Shot::encode(stream::JpegEncoder& encoder, render::Frame frame) {
  Result<void> result;
  std::string file;
  const auto& pixels = *frame.pixels;
  if (settings_.codec == v1::CODEC_PFM) {
    file = stream::encodePfm(frame.radiance, pixels.width, pixels.height);
  } else if (settings_.codec == v1::CODEC_JPEG) {
    result = encoder.encode(pixels, settings_.jpeg_quality, file);
  } else if (auto png = stream::encodePng(pixels); png) {
    file = std::move(*png);
  } else {
    result = png.error();
  }
  if (!result) return end(result.error());

  std::lock_guard lock(mutex_);
  auto& header = *header_.emplace().mutable_header();
  header.set_codec(settings_.codec);
  header.set_width(pixels.width);
  header.set_height(pixels.height);
  header.set_size(file.size());
  header.set_samples(frame.stats.accumulated);
  header.set_applied_seq(frame.stats.applied_seq);
  header.set_exposure(static_cast<float>(frame.stats.exposure));
  header.set_gpu_ms(gpu_ms_);
  *header.mutable_rays() = toWire(rays_);
  file_ = std::move(file);
  encoded_ = true;
  pump();
}

void Shot::end(const Failure& failure) {
  std::lock_guard lock(mutex_);
  if (ending_ || finished_) return;
  // A picture that is being sent needs the world no more: going down lets it finish within the drain time.
  const bool needs_the_world =
      failure.reason != v1::ERROR_REASON_INTERNAL && failure.reason != v1::ERROR_REASON_UNAUTHENTICATED;
  if (rendered_ && needs_the_world) return;
  ending_ = failure;
  pump();
}

void Shot::pump() {
  if (writing_ || finished_) return;
  if (gone_) return finish(grpc::Status::CANCELLED);
  if (ending_) return finish(toStatus(*ending_, context_));
  if (progress_) {
    out_ = *std::exchange(progress_, std::nullopt);
  } else if (header_) {
    out_ = *std::exchange(header_, std::nullopt);
  } else if (encoded_ && sent_ < file_.size()) {
    out_.mutable_chunk()->set_data(file_.substr(sent_, kChunkBytes));
    sent_ += out_.chunk().data().size();
  } else {
    if (encoded_) finish(grpc::Status::OK);
    return;
  }
  writing_ = true;
  StartWrite(&out_);
}

void Shot::finish(grpc::Status status) {
  finished_ = true;
  Finish(std::move(status));
}

void Shot::OnWriteDone(bool ok) {
  std::lock_guard lock(mutex_);
  writing_ = false;
  if (!ok) gone_ = true;
  pump();
}

void Shot::OnCancel() {
  leave();
  std::lock_guard lock(mutex_);
  gone_ = true;
  pump();
}

void Shot::leave() {
  if (world_) world_->detach(this);
}

void Shot::OnDone() {
  leave();
  place_.reset();
  session_.reset();
  self_.reset();
}

}  // namespace helio::service
