#include "service/viewer_stream.h"

#include <spdlog/spdlog.h>
#include <sys/random.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace helio::service {
namespace {

constexpr auto kStillAfter = std::chrono::milliseconds(500);  // a pause in a flight is not the end of it
constexpr size_t kResumeTokenBytes = 16;
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
    case v1::ERROR_REASON_SUPERSEDED:
      notice.set_kind(v1::NOTICE_KIND_SUPERSEDED);
      break;
    case v1::ERROR_REASON_FENCED:
      notice.set_kind(v1::NOTICE_KIND_MOVED);
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

stream::RateControl::Wishes wishesOf(const ViewerSettings& settings) {
  return {settings.max_fps, settings.max_kbps, std::chrono::milliseconds(settings.max_latency_ms),
          settings.jpeg_quality, settings.still_quality};
}

std::string newResumeToken() {
  std::string token(kResumeTokenBytes, '\0');
  if (getrandom(token.data(), token.size(), 0) != static_cast<ssize_t>(token.size()))
    throw std::runtime_error("the system has no random numbers for a viewer");
  return token;
}

bool samePlace(const scene::Camera& a, const scene::Camera& b) {
  return a.position == b.position && a.forward == b.forward && a.up == b.up && a.vfov == b.vfov;
}

}  // namespace

ViewerStream* ViewerStream::open(const StreamEnvironment& environment, grpc::CallbackServerContext& context) {
  std::shared_ptr<ViewerStream> stream(new ViewerStream(environment, context));
  stream->self_ = stream;
  if (auto admitted = stream->admit(); !admitted) stream->end(admitted.error());
  else stream->StartRead(&stream->in_);
  return stream.get();
}

ViewerStream::ViewerStream(const StreamEnvironment& environment, grpc::CallbackServerContext& context)
    : environment_(environment),
      context_(context),
      window_(settings_.max_fps, maxLatency()),
      rate_(wishesOf(settings_)) {}

Outcome<void> ViewerStream::admit() {
  auto caller = environment_.access->admit(context_, "ViewerService.Attach");
  if (!caller) return caller.error();
  caller_ = std::move(*caller);
  session_ = environment_.access->enter(caller_, [weak = weak_from_this()](const Failure& why, bool at_once) {
    const auto stream = weak.lock();
    if (!stream) return;
    if (at_once) return stream->context_.TryCancel();
    stream->leave();
    stream->end(why);
  });
  return {};
}

// ---- From the client
// -------------------------------------------------------------------------------------------------

void ViewerStream::OnReadDone(bool ok) {
  if (!ok) {
    leave(patience());  // a farewell or a broken connection: OnDone knows which
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
  if (auto allowed = AccessControl::checkWorld(caller_, hello.world()); !allowed) return allowed;
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
    first = {*camera, hello.camera().id(), hello.camera().client_ns(), Clock::now(), Clock::now(), false};
  }
  first.moved = Clock::now();
  const std::string resume_token =
      hello.resume_token().size() == kResumeTokenBytes ? hello.resume_token() : newResumeToken();
  auto place = environment_.worlds->admitViewer((*world)->knows(keyOf(resume_token)));
  if (!place) return place.error();

  {
    std::lock_guard lock(mutex_);
    world_ = *world;
    place_ = *place;
    id_ = environment_.next_viewer->fetch_add(1);
    settings_ = *wanted;
    steer();
    camera_ = first;
    resume_token_ = resume_token;
    window_.configure(settings_.max_fps, maxLatency());
    rate_.configure(wishesOf(settings_));
  }
  const auto resumed = world_->attach(shared_from_this(), keyOf(resume_token));
  if (!resumed) return resumed.error();
  if (*resumed) environment_.metrics->resumed.Increment();
  {
    std::lock_guard lock(mutex_);
    welcome_.emplace();
    auto& welcome = *welcome_->mutable_welcome();
    welcome.set_viewer(id_);
    welcome.set_world(world_->name());
    welcome.set_seq((*content)->seq());
    welcome.set_epoch(world_->epoch());
    *welcome.mutable_settings()->mutable_settings() = toWire(settings_);
    welcome.set_resume_token(resume_token_);
    welcome.set_resumed(*resumed);
    welcomed_ = true;
    pump();
  }
  world_->wake();
  return {};
}

/// A view is found again by the same caller only.
std::string ViewerStream::keyOf(const std::string& resume_token) const {
  return (caller_.token ? caller_.token->id : std::string()) + "/" + resume_token;
}

Outcome<void> ViewerStream::camera(const v1::Camera& message) {
  auto camera = fromWire(message, "camera", *environment_.limits);
  if (!camera) return camera.error();
  std::lock_guard lock(mutex_);
  const auto now = Clock::now();
  const auto moved = samePlace(*camera, camera_.camera) ? camera_.moved : now;
  camera_ = {*camera, message.id(), message.client_ns(), now, moved, false};
  return {};
}

Outcome<void> ViewerStream::settings(const v1::Settings& message) {
  auto wanted = fromWire(message, *environment_.limits);
  if (!wanted) return wanted.error();
  {
    std::lock_guard lock(mutex_);
    settings_ = *wanted;
    steer();
    ++settings_change_;
    window_.configure(settings_.max_fps, maxLatency());
    rate_.configure(wishesOf(settings_));
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
    const auto now = Clock::now();
    if (!window_.acknowledged(ack.frame_id(), held, now)) return;
    rate_.acknowledged(ack.frame_id(), window_.lastRoundTrip(), *window_.smallestRoundTrip(), now);
    environment_.metrics->round_trip.Observe(std::chrono::duration<double>(window_.lastRoundTrip()).count());
    pump();
  }
  world_->wake();
}

void ViewerStream::OnCancel() { leave(patience()); }

/// The client is gone or wrong: its frames are let go, its view is freed or waits for its return.
void ViewerStream::leave(std::chrono::seconds keep) {
  WorldPtr world;
  ViewerPlace place;
  {
    std::lock_guard lock(mutex_);
    world = world_;
    place = std::move(place_);
    mailbox_.clear();
    encoded_.reset();
  }
  if (world) world->detach(this, keep, std::move(place));
}

void ViewerStream::OnDone() {
  bool farewell = false, ended = false;
  {
    std::lock_guard lock(mutex_);
    ended = ending_.has_value();
    farewell = half_closed_ && !ended && !context_.IsCancelled();
  }
  leave(farewell || ended ? std::chrono::seconds(0) : patience());
  if (farewell && world_) world_->forget(keyOf(resume_token_));
  session_.reset();
  self_.reset();
}

// ---- From the world's thread
// -----------------------------------------------------------------------------------------

std::optional<Clock::time_point> ViewerStream::wantedFrom(Clock::time_point now) {
  std::lock_guard lock(mutex_);
  if (!welcomed_ || settings_.paused || ending_ || half_closed_ || finished_ || !window_.open(now)) return std::nullopt;
  return std::max(next_frame_, rate_.nextFrame());
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
  view_in_tick_ = controller_ ? render::onRung(settings_.view, controller_->decision().rung) : settings_.view;
  return {in_tick_.camera, view_in_tick_, std::exchange(capture_, nullptr)};
}

/// A goal is followed from where it was, as long as it is the same.
void ViewerStream::steer() {
  if (!settings_.goal) controller_.reset();
  else if (!controller_ || controller_->goal() != *settings_.goal)
    controller_.emplace(*environment_.prices, *settings_.goal);
}

/// What was decided for the frame of this tick; its figures decide about the next.
std::optional<v1::Decision> ViewerStream::steeredBy(const render::FrameStats& stats) {
  if (!controller_) return std::nullopt;
  const render::Observation observation = render::observe(stats, view_in_tick_);
  v1::Decision decision = toWire(controller_->decision(), observation);
  controller_->observe(observation);
  return decision;
}

bool ViewerStream::captureNext(Capture capture) {
  std::lock_guard lock(mutex_);
  capture_ = std::move(capture);
  return true;
}

void ViewerStream::deliver(render::Frame frame, Clock::duration tick) {
  std::lock_guard lock(mutex_);
  counters_.countDropped(frame.stats.dropped);
  if (ending_ || half_closed_ || finished_ || change_in_tick_ != settings_change_) return;
  const bool still = tick_started_ - in_tick_.moved >= kStillAfter;
  auto decision = steeredBy(frame.stats);
  auto error = render::believe(*environment_.prices, view_in_tick_, frame.stats);
  Rendered rendered{std::move(frame), in_tick_, {}, still, settings_change_, std::move(decision), error};
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

void ViewerStream::tend(Clock::time_point now) {
  const uint32_t patience = environment_.limits->max_silence_seconds;
  {
    std::lock_guard lock(mutex_);
    if (ending_ || half_closed_ || finished_ || window_.silence(now) < std::chrono::seconds(patience)) return;
  }
  environment_.metrics->ghosts.Increment();
  spdlog::info("viewer {}: acknowledged nothing for {} s; its stream ends", id_, patience);
  leave(this->patience());
  end(fellSilent(patience));
  std::lock_guard lock(mutex_);
  if (writing_) context_.TryCancel();  // nobody reads: nothing that is said would arrive
}

std::optional<ViewerStatus> ViewerStream::status() const {
  std::lock_guard lock(mutex_);
  ViewerStatus status{id_,
                      caller_.token ? caller_.token->id : std::string(),
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
  const int quality = rate_.quality(taken.content.still);
  environment_.encoders->submit(
      [self = shared_from_this(), quality,
       taken = std::make_shared<stream::Mailbox<Rendered>::Taken>(std::move(taken))](stream::JpegEncoder& encoder) {
        self->encode(encoder, std::move(taken->content), quality, taken->waited, taken->dropped_before);
      });
}

/// On a thread of the pool, without the lock.
void ViewerStream::encode(stream::JpegEncoder& encoder, Rendered rendered, int quality, Clock::duration waited,
                          uint32_t dropped_before) {
  const auto start = Clock::now();
  Encoded encoded;
  auto& frame = *encoded.message.mutable_frame();
  const auto result = encoder.encode(*rendered.frame.pixels, quality, *frame.mutable_data());
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
  frame.set_still(rendered.still);
  *frame.mutable_telemetry() = service::toWire(stats);
  frame.mutable_telemetry()->set_dropped_before(dropped_before);
  frame.mutable_telemetry()->set_jpeg_quality(static_cast<uint32_t>(quality));
  if (rendered.decision) *frame.mutable_telemetry()->mutable_decision() = std::move(*rendered.decision);
  if (rendered.error) *frame.mutable_telemetry()->mutable_error() = service::toWire(*rendered.error);
  encoded.stages = rendered.stages;
  encoded.stages.mailbox = telemetry::microseconds(waited);
  encoded.stages.encode = telemetry::microseconds(Clock::now() - start);
  encoded.stats = std::move(rendered.frame.stats);
  encoded.dropped_before = dropped_before;
  encoded.jpeg_quality = quality;
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
  rate_.sent(last_frame_, frame.data().size(), encoded.jpeg_quality, now);
  auto& metrics = *environment_.metrics;
  metrics.frames.Increment();
  metrics.frame_bytes.Increment(static_cast<double>(frame.data().size()));
  metrics.frames_dropped.Increment(encoded.dropped_before);
  metrics.encode.Observe(static_cast<double>(encoded.stages.encode) / 1e6);
  for (const double ms : world_->editLatency().shown(encoded.stats.applied_seq, now))
    metrics.edit_to_picture.Observe(ms / 1e3);
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
  if (!ok) leave(patience());  // the connection broke; OnReadDone or OnCancel says so too
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
