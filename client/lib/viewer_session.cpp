#include "lib/viewer_session.h"

#include <algorithm>
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
  std::unique_ptr<ViewerSession> session(new ViewerSession);
  Connection::route(session->context_, options.world);
  session->stream_ = connection.viewers().Attach(&session->context_);
  v1::ViewerMessage message;
  auto& hello = *message.mutable_hello();
  hello.set_world(options.world);
  *hello.mutable_settings() = options.settings;
  hello.add_codecs(v1::CODEC_JPEG);
  if (options.camera) {
    *hello.mutable_camera() = *options.camera;
    hello.mutable_camera()->set_id(++session->last_camera_);
    hello.mutable_camera()->set_client_ns(nanoseconds(Clock::now()));
  }
  session->write(message);
  v1::ServerMessage answer;
  if (!session->stream_->Read(&answer)) return session->finish();
  if (!answer.has_welcome()) return Error{ErrorKind::internal, "the server's first message is no welcome", {}, {}, {}};
  session->welcome_ = answer.welcome();
  return session;
}

ViewerSession::~ViewerSession() {
  if (!stream_ || finished_) return;
  context_.TryCancel();
  stream_->Finish();
}

void ViewerSession::write(const v1::ViewerMessage& message) {
  std::lock_guard lock(write_mutex_);
  if (!left_) stream_->Write(message);  // a broken stream says so to the reader
}

uint64_t ViewerSession::look(v1::Camera camera) {
  v1::ViewerMessage message;
  std::lock_guard lock(write_mutex_);
  camera.set_id(++last_camera_);
  camera.set_client_ns(nanoseconds(Clock::now()));
  *message.mutable_camera() = std::move(camera);
  if (!left_) stream_->Write(message);
  return last_camera_;
}

void ViewerSession::change(const v1::Settings& settings) {
  v1::ViewerMessage message;
  *message.mutable_settings() = settings;
  write(message);
}

void ViewerSession::leave() {
  std::lock_guard lock(write_mutex_);
  if (!std::exchange(left_, true)) stream_->WritesDone();
}

Error ViewerSession::finish() {
  finished_ = true;
  const auto status = stream_->Finish();
  Error error = errorOf(status, context_);
  if (error.message.find(notice_) == std::string::npos) error.message += " (" + notice_ + ")";
  if (status.ok()) error.message = "the server ended the stream";
  return error;
}

Result<std::optional<ViewerSession::Received>> ViewerSession::next() {
  v1::ServerMessage message;
  while (stream_->Read(&message)) {
    const auto arrived = Clock::now();
    if (message.has_notice()) notice_ = message.notice().text();
    if (message.has_frame()) return std::optional<Received>(Received{std::move(*message.mutable_frame()), arrived});
  }
  Error error = finish();
  std::lock_guard lock(write_mutex_);
  if (left_) return std::optional<Received>();
  return error;
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
