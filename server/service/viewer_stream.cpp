#include "service/viewer_stream.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>

namespace helio::service {
namespace {

constexpr int64_t kMaxHeldUs = 60'000'000;  // beyond a minute a client's figure is not a measurement

v1::Notice noticeOf(const Failure& failure) {
  v1::Notice notice;
  switch (failure.reason) {
    case v1::ERROR_REASON_DRAINING:
      notice.set_kind(v1::NOTICE_KIND_DRAINING);
      break;
    case v1::ERROR_REASON_WORLD_DELETED:
      notice.set_kind(v1::NOTICE_KIND_WORLD_DELETED);
      break;
    default:
      break;
  }
  notice.set_text(failure.error.message);
  notice.set_retry_after_ms(failure.retry_after_ms);
  return notice;
}

v1::Stages toWire(const telemetry::Stages& stages) {
  v1::Stages out;
  out.set_camera_wait_us(static_cast<uint32_t>(stages.camera_wait));
  out.set_tick_us(static_cast<uint32_t>(stages.tick));
  out.set_mailbox_us(static_cast<uint32_t>(stages.mailbox));
  out.set_encode_us(static_cast<uint32_t>(stages.encode));
  out.set_queue_us(static_cast<uint32_t>(stages.queue));
  out.set_previous_write_us(static_cast<uint32_t>(stages.write));
  return out;
}

}  // namespace

ViewerStream* ViewerStream::open(const StreamEnvironment& environment, grpc::CallbackServerContext& context) {
  std::shared_ptr<ViewerStream> stream(new ViewerStream(environment, context));
  stream->self_ = stream;
  stream->StartRead(&stream->in_);
  return stream.get();
}

ViewerStream::ViewerStream(const StreamEnvironment& environment, grpc::CallbackServerContext& context)
    : environment_(environment), context_(context), window_(settings_.max_fps, maxLatency()) {}

// ---- From the client
// -------------------------------------------------------------------------------------------------

void ViewerStream::OnReadDone(bool ok) {
  if (!ok) {
    leave();
    std::lock_guard lock(mutex_);
    half_closed_ = true;
    pump();
    return;
  }
  if (auto received = receive(in_); !received) {
    leave();
    end(received.error());
    return;
  }
  StartRead(&in_);
}

Outcome<void> ViewerStream::receive(const v1::ViewerMessage& message) {
  if (!world_ && !message.has_hello()) return outOfRange("kind", "not hello", "hello as the first message");
  switch (message.kind_case()) {
    case v1::ViewerMessage::kHello:
      if (world_) return outOfRange("kind", "a second hello", "one hello a stream");
      return hello(message.hello());
    case v1::ViewerMessage::kCamera:
      return camera(message.camera());
    case v1::ViewerMessage::kSettings:
      return settings(message.settings());
    case v1::ViewerMessage::kAck:
      acknowledge(message.ack());
      return {};
    case v1::ViewerMessage::KIND_NOT_SET:
      break;
  }
  // A newer client's kind of message.
  std::lock_guard lock(mutex_);
  if (++unknown_messages_ == 1) spdlog::warn("viewer {}: messages of an unknown kind are ignored", id_);
  return {};
}

Outcome<void> ViewerStream::hello(const v1::Hello& hello) {
  // Check all of it before anything is taken.
  auto world = environment_.worlds->find(hello.world());
  if (!world) return world.error();
  auto content = (*world)->content();
  if (!content) return content.error();
  auto wanted = fromWire(hello.settings(), *environment_.limits);
  if (!wanted) return wanted.error();
  const auto& codecs = hello.codecs();
  if (!codecs.empty() && std::find(codecs.begin(), codecs.end(), v1::CODEC_JPEG) == codecs.end())
    return outOfRange("hello.codecs", "without CODEC_JPEG", "lists with CODEC_JPEG");
  CameraInUse first;
  first.camera = (*content)->scene().cameras.front().camera;
  if (hello.has_camera()) {
    auto camera = fromWire(hello.camera(), "hello.camera", *environment_.limits);
    if (!camera) return camera.error();
    first = {*camera, hello.camera().id(), hello.camera().client_ns(), Clock::now(), false};
  }
  auto place = environment_.worlds->admitViewer();
  if (!place) return place.error();

  {
    std::lock_guard lock(mutex_);
    world_ = *world;
    place_ = *place;
    id_ = environment_.next_viewer->fetch_add(1);
    settings_ = *wanted;
    camera_ = first;
    window_.configure(settings_.max_fps, maxLatency());
    welcome_.emplace();
    auto& welcome = *welcome_->mutable_welcome();
    welcome.set_viewer(id_);
    welcome.set_world(world_->name());
    welcome.set_seq((*content)->seq());
    welcome.set_epoch(world_->epoch());
    *welcome.mutable_settings()->mutable_settings() = toWire(settings_);
    pump();
  }
  return world_->attach(shared_from_this());
}

Outcome<void> ViewerStream::camera(const v1::Camera& message) {
  auto camera = fromWire(message, "camera", *environment_.limits);
  if (!camera) return camera.error();
  std::lock_guard lock(mutex_);
  camera_ = {*camera, message.id(), message.client_ns(), Clock::now(), false};
  return {};
}

Outcome<void> ViewerStream::settings(const v1::Settings& message) {
  auto wanted = fromWire(message, *environment_.limits);
  if (!wanted) return wanted.error();
  {
    std::lock_guard lock(mutex_);
    settings_ = *wanted;
    ++settings_change_;
    window_.configure(settings_.max_fps, maxLatency());
    mailbox_.clear();  // every frame after the answer has the new settings
    encoded_.reset();
    settings_answer_.emplace();
    *settings_answer_->mutable_settings()->mutable_settings() = toWire(settings_);
    pump();
  }
  world_->wake();
  return {};
}

void ViewerStream::acknowledge(const v1::Ack& ack) {
  {
    std::lock_guard lock(mutex_);
    const auto held = std::chrono::microseconds(std::min<int64_t>(ack.held_us(), kMaxHeldUs));
    if (!window_.acknowledged(ack.frame_id(), held, Clock::now())) return;
    pump();
  }
  world_->wake();
}

void ViewerStream::OnCancel() { leave(); }

/// The client is gone or wrong: its view is freed, its frames are let go.
void ViewerStream::leave() {
  WorldPtr world;
  {
    std::lock_guard lock(mutex_);
    world = world_;
    place_.reset();
    mailbox_.clear();
    encoded_.reset();
  }
  if (world) world->detach(this);
}

void ViewerStream::OnDone() {
  leave();
  self_.reset();
}

// ---- From the world's thread
// -----------------------------------------------------------------------------------------

std::optional<Clock::time_point> ViewerStream::wantedFrom(Clock::time_point now) {
  std::lock_guard lock(mutex_);
  if (settings_.paused || ending_ || half_closed_ || finished_ || !window_.open(now)) return std::nullopt;
  return next_frame_;
}

ViewDemand ViewerStream::demand(Clock::time_point now) {
  std::lock_guard lock(mutex_);
  // Keep the pace when late by less than a frame; do not catch up what was missed.
  const auto period =
      std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(1.0 / settings_.max_fps));
  next_frame_ = std::max(next_frame_ + period, now);
  tick_started_ = now;
  in_tick_ = camera_;
  change_in_tick_ = settings_change_;
  camera_.rendered = true;
  return {in_tick_.camera, settings_.view};
}

void ViewerStream::deliver(render::Frame frame, Clock::duration tick) {
  std::lock_guard lock(mutex_);
  counters_.countDropped(frame.stats.dropped);
  if (ending_ || half_closed_ || finished_ || change_in_tick_ != settings_change_) return;
  Rendered rendered{std::move(frame), in_tick_, {}, settings_.jpeg_quality, settings_change_};
  if (!in_tick_.rendered && in_tick_.arrived != Clock::time_point{})
    rendered.stages.camera_wait = telemetry::microseconds(tick_started_ - in_tick_.arrived);
  rendered.stages.tick = telemetry::microseconds(tick);
  mailbox_.put(std::move(rendered), Clock::now());
  pump();
}

void ViewerStream::end(const Failure& failure) {
  std::lock_guard lock(mutex_);
  if (ending_ || finished_) return;
  ending_ = failure;
  mailbox_.clear();
  encoded_.reset();
  if (auto notice = noticeOf(failure); notice.kind() != v1::NOTICE_KIND_UNSPECIFIED)
    *notice_.emplace().mutable_notice() = std::move(notice);
  pump();
}

std::optional<ViewerStatus> ViewerStream::status() const {
  std::lock_guard lock(mutex_);
  ViewerStatus status{id_,
                      settings_.view,
                      counters_,
                      window_.unacknowledged(),
                      window_.size(),
                      window_.smallestRoundTrip(),
                      window_.lastAcknowledged()};
  status.counters.dropped += mailbox_.dropped();  // what a stalled reader loses is seen while it is stalled
  return status;
}

// ---- To the client
// ---------------------------------------------------------------------------------------------------

/// Starts whatever can start: one write, and one picture in the encoder.
void ViewerStream::pump() {
  if (finished_) return;
  if (!writing_) {
    if (welcome_) write(*std::exchange(welcome_, std::nullopt));
    else if (settings_answer_) write(*std::exchange(settings_answer_, std::nullopt));
    else if (notice_) write(*std::exchange(notice_, std::nullopt));
    else if (ending_) finish(toStatus(*ending_, context_));
    else if (half_closed_) finish(grpc::Status::OK);
    else if (encoded_) writeFrame();
  }
  if (finished_ || ending_ || half_closed_ || encoding_ || encoded_ || writing_) return;
  const auto now = Clock::now();
  if (!window_.open(now)) return;
  if (auto taken = mailbox_.take(now, maxLatency())) startEncoding(std::move(*taken));
}

void ViewerStream::startEncoding(stream::Mailbox<Rendered>::Taken taken) {
  encoding_ = true;
  environment_.encoders->submit([self = shared_from_this(), taken = std::make_shared<stream::Mailbox<Rendered>::Taken>(
                                                                std::move(taken))](stream::JpegEncoder& encoder) {
    self->encode(encoder, std::move(taken->content), taken->waited, taken->dropped_before);
  });
}

/// On a thread of the pool, without the lock.
void ViewerStream::encode(stream::JpegEncoder& encoder, Rendered rendered, Clock::duration waited,
                          uint32_t dropped_before) {
  const auto start = Clock::now();
  Encoded encoded;
  auto& frame = *encoded.message.mutable_frame();
  const auto result = encoder.encode(*rendered.frame.pixels, rendered.jpeg_quality, *frame.mutable_data());
  frame.set_width(rendered.frame.pixels->width);
  frame.set_height(rendered.frame.pixels->height);
  rendered.frame.pixels.reset();  // back to the renderer's pool
  const auto& stats = rendered.frame.stats;
  frame.set_tick(stats.tick);
  frame.set_applied_seq(stats.applied_seq);
  frame.set_epoch(world_->epoch());
  frame.set_camera_id(rendered.camera.id);
  frame.set_camera_client_ns(rendered.camera.client_ns);
  frame.set_codec(v1::CODEC_JPEG);
  frame.set_keyframe(true);
  *frame.mutable_telemetry() = service::toWire(stats);
  frame.mutable_telemetry()->set_dropped_before(dropped_before);
  encoded.stages = rendered.stages;
  encoded.stages.mailbox = telemetry::microseconds(waited);
  encoded.stages.encode = telemetry::microseconds(Clock::now() - start);
  encoded.stats = std::move(rendered.frame.stats);
  encoded.dropped_before = dropped_before;
  encoded.settings_change = rendered.settings_change;
  encoded.since = Clock::now();

  if (!result) {
    leave();
    end(result.error());
  }
  std::lock_guard lock(mutex_);
  encoding_ = false;
  if (!ending_ && !half_closed_ && encoded.settings_change == settings_change_) encoded_ = std::move(encoded);
  pump();
}

void ViewerStream::writeFrame() {
  Encoded encoded = std::move(*std::exchange(encoded_, std::nullopt));
  const auto now = Clock::now();
  encoded.stages.queue = telemetry::microseconds(now - encoded.since);
  encoded.stages.write = telemetry::microseconds(previous_write_);
  auto& frame = *encoded.message.mutable_frame();
  frame.set_id(++last_frame_);
  *frame.mutable_telemetry()->mutable_stages() = toWire(encoded.stages);
  window_.sent(last_frame_, now);
  world_->editLatency().shown(encoded.stats.applied_seq, now);
  counters_.count(encoded.stages, encoded.dropped_before, frame.data().size());
  counters_.newest = std::move(encoded.stats);
  write(std::move(encoded.message));
}

void ViewerStream::write(v1::ServerMessage message) {
  out_ = std::move(message);
  writing_ = true;
  write_started_ = Clock::now();
  StartWrite(&out_);
}

void ViewerStream::OnWriteDone(bool ok) {
  if (!ok) leave();  // the connection broke; OnReadDone or OnCancel says so too
  std::lock_guard lock(mutex_);
  writing_ = false;
  previous_write_ = Clock::now() - write_started_;
  if (!ok) half_closed_ = true;
  pump();
}

void ViewerStream::finish(grpc::Status status) {
  finished_ = true;
  Finish(std::move(status));
}

}  // namespace helio::service
