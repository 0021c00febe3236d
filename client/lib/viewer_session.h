// A viewer's side of the stream: cameras and settings out, frames in, acknowledgements with this client's times.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "lib/connection.h"

namespace helio::client {

/// One thread calls next() and shown(), any thread the others.
class ViewerSession {
 public:
  struct Options {
    std::string world;
    v1::Settings settings;
    std::optional<v1::Camera> camera;  ///< none: the world's first
  };

  /// Waits until the world is loaded. Errors: the server's.
  static Result<std::unique_ptr<ViewerSession>> attach(Connection& connection, const Options& options);
  ~ViewerSession();

  const v1::Welcome& welcome() const { return welcome_; }

  /// Sends a camera under a new id, with the present time; returns the id.
  uint64_t look(v1::Camera camera);
  void change(const v1::Settings& settings);
  /// No more messages: the server ends the stream, and next() comes to its end.
  void leave();

  struct Received {
    v1::Frame frame;
    Clock::time_point arrived;
  };
  /// The next frame; none: the stream has ended in order. Errors: the server's; a notice is part of the message.
  Result<std::optional<Received>> next();

  /// The frame is shown (or stored) now: acknowledges it. Returns motion-to-photon in milliseconds, when this is the
  /// first frame with a camera of this session: present time - that camera's client_ns, both by this machine's clock.
  std::optional<double> shown(const Received& received, Clock::time_point decoded);

 private:
  ViewerSession() = default;
  void write(const v1::ViewerMessage& message);
  Error finish();

  grpc::ClientContext context_;
  std::unique_ptr<grpc::ClientReaderWriter<v1::ViewerMessage, v1::ServerMessage>> stream_;
  v1::Welcome welcome_;
  std::string notice_;
  uint64_t newest_shown_camera_ = 0;
  std::mutex write_mutex_;  // gRPC allows one writer beside one reader
  uint64_t last_camera_ = 0;
  bool left_ = false, finished_ = false;
};

}  // namespace helio::client
