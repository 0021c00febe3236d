// A viewer's side of the stream: cameras and settings out, frames in, acknowledgements with this client's times.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "lib/connection.h"

namespace helio::client {

/// `connection` outlives it. One thread calls next() and shown(), any thread the others.
class ViewerSession {
 public:
  struct Options {
    std::string world;
    v1::Settings settings;
    std::optional<v1::Camera> camera;  ///< none: the world's first
    /// How long next() tries to attach again after the connection broke or the server went down; zero: not at all.
    std::chrono::seconds reattach{0};
  };

  /// Waits until the world is loaded. Errors: the server's.
  static Result<std::unique_ptr<ViewerSession>> attach(Connection& connection, const Options& options);
  ~ViewerSession();

  /// Of the present stream.
  const v1::Welcome& welcome() const { return welcome_; }
  /// How often the stream was resumed.
  uint32_t reattached() const { return reattached_; }

  /// Sends a camera under a new id, with the present time; returns the id.
  uint64_t look(v1::Camera camera);
  void change(const v1::Settings& settings);
  /// No more messages: the server ends the stream, and next() comes to its end.
  void leave();
  /// Ends the stream at once: next() comes to its end with an error. Not with Options::reattach, which replaces
  /// streams.
  void cancel() { stream_->context.TryCancel(); }

  struct Received {
    v1::Frame frame;
    Clock::time_point arrived;
  };
  /// The next frame; none: the stream has ended in order. With Options::reattach a broken stream is resumed first, with
  /// the newest camera and settings; frame ids start again. Errors: the server's; a notice is part of the message.
  Result<std::optional<Received>> next();

  /// The frame is shown (or stored) now: acknowledges it. Returns motion-to-photon in milliseconds, when this is the
  /// first frame with a camera of this session: present time - that camera's client_ns, both by this machine's clock.
  std::optional<double> shown(const Received& received, Clock::time_point decoded);

 private:
  /// How a stream ended.
  struct Ending {
    Error error;
    bool passing = false;  ///< attaching again may help: the connection broke, the server goes down, the world loads
    uint32_t retry_after_ms = 0;
  };
  struct Stream {
    grpc::ClientContext context;
    std::unique_ptr<grpc::ClientReaderWriter<v1::ViewerMessage, v1::ServerMessage>> calls;
  };

  ViewerSession(Connection& connection, const Options& options) : connection_(connection), options_(options) {}
  Result<void> open();
  Result<void> reopen(const Ending& ending);
  void write(const v1::ViewerMessage& message);
  Ending finish();

  Connection& connection_;
  Options options_;  ///< with the newest camera and settings: what a resumed stream begins with
  std::unique_ptr<Stream> stream_;
  uint32_t reattached_ = 0;
  v1::Welcome welcome_;
  std::string notice_;
  uint64_t newest_shown_camera_ = 0;
  std::mutex write_mutex_;  // gRPC allows one writer beside one reader
  uint64_t last_camera_ = 0;
  bool left_ = false, finished_ = false;  ///< of the present stream
};

}  // namespace helio::client
