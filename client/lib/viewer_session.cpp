#include "lib/viewer_session.h"

#include <algorithm>
#include <thread>
#include <utility>

namespace helio::client {
namespace {

uint64_t nanoseconds(Clock::time_point t) {
  return static_cast<uint64_t>(std::chrono::duration_cast<std::chrono::nanoseconds>(t.time_since_epoch()).count());
}

uint32_t microseconds(Clock::duration d) {
  return static_cast<uint32_t>(
      std::clamp<int64_t>(std::chrono::duration_cast<std::chrono::microseconds>(d).count(), 0, UINT32_MAX));
}

}  // namespace

Result<std::unique_ptr<ViewerSession>> ViewerSession::attach(Connection& connection, const Options& options) {
  if (auto ready = connection.readyWorld(options.world); !ready) return ready.error();
  std::unique_ptr<ViewerSession> session(new ViewerSession(connection, options));
  if (session->options_.camera) {
    session->options_.camera->set_id(++session->last_camera_);
    session->options_.camera->set_client_ns(nanoseconds(Clock::now()));
  }
  if (auto opened = session->open(); !opened) return opened.error();
  return session;
}

/// Hello and Welcome. Hello carries the whole state, so that nothing drifts over reconnections.
Result<void> ViewerSession::open() {
  auto stream = std::make_unique<Stream>();
  Connection::route(stream->context, options_.world);
  v1::ViewerMessage message;
  {
    std::lock_guard lock(write_mutex_);
    auto& hello = *message.mutable_hello();
    hello.set_world(options_.world);
    *hello.mutable_settings() = options_.settings;
    hello.add_codecs(v1::CODEC_JPEG);
    hello.set_resume_token(welcome_.resume_token());
    if (options_.camera) *hello.mutable_camera() = *options_.camera;
    stream->calls = connection_.viewers().Attach(&stream->context);
    stream->calls->Write(message);
    stream_ = std::move(stream);
    finished_ = false;
    if (left_) stream_->calls->WritesDone();
  }
  v1::ServerMessage answer;
  if (!stream_->calls->Read(&answer)) return finish().error;
  if (!answer.has_welcome()) return Error{ErrorKind::internal, "the server's first message is no welcome", {}, {}, {}};
  welcome_ = answer.welcome();
  return {};
}

/// Tries until it is attached again, it was left, or patience is over.
Result<void> ViewerSession::reopen(const Ending& ending) {
  const auto until = Clock::now() + options_.reattach;
  auto wait = std::chrono::milliseconds(std::max(ending.retry_after_ms, 100u));
  for (;;) {
    std::this_thread::sleep_for(
        std::min<Clock::duration>(wait, std::max(until - Clock::now(), Clock::duration::zero())));
    {
      std::lock_guard lock(write_mutex_);
      if (left_) return ending.error;
    }
    // It repeats by itself while nobody answers or the world is being loaded.
    auto ready = connection_.readyWorld(options_.world);
    auto opened = ready ? open() : Result<void>(ready.error());
    if (opened) {
      ++reattached_;
      return {};
    }
    if (Clock::now() >= until || opened.error().kind != ErrorKind::unavailable) return opened.error();
    wait = std::min(2 * wait, std::chrono::milliseconds(1000));
  }
}

ViewerSession::~ViewerSession() {
  if (!stream_ || finished_) return;
  stream_->context.TryCancel();
  stream_->calls->Finish();
}

void ViewerSession::write(const v1::ViewerMessage& message) {
  std::lock_guard lock(write_mutex_);
  if (!left_) stream_->calls->Write(message);  // a broken stream says so to the reader
}

uint64_t ViewerSession::look(v1::Camera camera) {
  v1::ViewerMessage message;
  std::lock_guard lock(write_mutex_);
  camera.set_id(++last_camera_);
  camera.set_client_ns(nanoseconds(Clock::now()));
  options_.camera = camera;
  *message.mutable_camera() = std::move(camera);
  if (!left_) stream_->calls->Write(message);
  return last_camera_;
}

void ViewerSession::change(const v1::Settings& settings) {
  v1::ViewerMessage message;
  *message.mutable_settings() = settings;
  {
    std::lock_guard lock(write_mutex_);
    options_.settings = settings;
  }
  write(message);
}

void ViewerSession::leave() {
  std::lock_guard lock(write_mutex_);
  if (!std::exchange(left_, true)) stream_->calls->WritesDone();
}

ViewerSession::Ending ViewerSession::finish() {
  finished_ = true;
  const auto status = stream_->calls->Finish();
  const auto detail = detailOf(stream_->context);
  Ending ending{errorOf(status, stream_->context), false, detail.retry_after_ms()};
  const bool told = detail.reason() != v1::ERROR_REASON_UNSPECIFIED;
  // Behind proxies a connection that broke is seen as other statuses too.
  ending.passing =
      told ? status.error_code() == grpc::StatusCode::UNAVAILABLE : status.error_code() != grpc::StatusCode::OK;
  if (!told && ending.passing) ending.error.kind = ErrorKind::unavailable;
  if (ending.error.message.find(notice_) == std::string::npos) ending.error.message += " (" + notice_ + ")";
  if (status.ok()) ending.error.message = "the server ended the stream";
  return ending;
}

Result<std::optional<ViewerSession::Received>> ViewerSession::next() {
  for (;;) {
    v1::ServerMessage message;
    while (stream_->calls->Read(&message)) {
      const auto arrived = Clock::now();
      if (message.has_notice()) notice_ = message.notice().text();
      if (message.has_frame()) return std::optional<Received>(Received{std::move(*message.mutable_frame()), arrived});
    }
    const Ending ending = finish();
    {
      std::lock_guard lock(write_mutex_);
      if (left_) return std::optional<Received>();
    }
    if (!ending.passing || options_.reattach.count() == 0) return ending.error;
    if (auto reopened = reopen(ending); !reopened) return reopened.error();
  }
}

std::optional<double> ViewerSession::shown(const Received& received, Clock::time_point decoded) {
  const auto now = Clock::now();
  const v1::Frame& frame = received.frame;
  v1::ViewerMessage message;
  auto& ack = *message.mutable_ack();
  ack.set_frame_id(frame.id());
  ack.set_held_us(microseconds(now - received.arrived));
  ack.set_decode_us(microseconds(decoded - received.arrived));
  ack.set_present_us(microseconds(now - decoded));
  write(message);
  if (frame.camera_id() <= newest_shown_camera_) return std::nullopt;
  newest_shown_camera_ = frame.camera_id();
  return static_cast<double>(nanoseconds(now) - frame.camera_client_ns()) / 1e6;
}

}  // namespace helio::client
