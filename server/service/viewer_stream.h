// One viewer: its stream of messages both ways, and what the world renders for it.
#pragma once

#include <heliograph/v1/viewer.grpc.pb.h>

#include <memory>
#include <mutex>
#include <optional>

#include "service/access_control.h"
#include "service/convert.h"
#include "service/world_registry.h"
#include "stream/encoder_pool.h"
#include "stream/mailbox.h"
#include "stream/rate_control.h"
#include "stream/window.h"

namespace helio::service {

/// What viewers, shots and measurements need of their server. Outlives them.
struct StreamEnvironment {
  WorldRegistry* worlds = nullptr;
  AccessControl* access = nullptr;
  telemetry::Metrics* metrics = nullptr;
  const Limits* limits = nullptr;
  stream::EncoderPool* encoders = nullptr;
  std::atomic<uint64_t>* next_viewer = nullptr;
  render::Renderer* renderer = nullptr;
  const render::PriceList* prices = nullptr;
};

/// Frames go: tick thread -> mailbox (newest wins) -> encoder pool -> one write in flight. Encoding starts when nothing
/// is being written: a viewer holds at most one frame in the mailbox and one on its way, however slow its client is.
class ViewerStream final : public grpc::ServerBidiReactor<v1::ViewerMessage, v1::ServerMessage>,
                           public ViewSink,
                           public std::enable_shared_from_this<ViewerStream> {
 public:
  /// Lives until gRPC is done with it and nobody else holds it.
  static ViewerStream* open(const StreamEnvironment& environment, grpc::CallbackServerContext& context);

  void OnReadDone(bool ok) override;
  void OnWriteDone(bool ok) override;
  void OnCancel() override;
  void OnDone() override;

  std::optional<Clock::time_point> wantedFrom(Clock::time_point now) override;
  ViewDemand demand(Clock::time_point now) override;
  void deliver(render::Frame frame, Clock::duration tick) override;
  void end(const Failure& failure) override;
  void tend(Clock::time_point now) override;
  bool captureNext(Capture capture) override;
  std::optional<ViewerStatus> status() const override;

 private:
  struct CameraInUse {
    scene::Camera camera;
    uint64_t id = 0;
    uint64_t client_ns = 0;
    Clock::time_point arrived{};
    Clock::time_point moved{};  ///< since then it has been where it is
    bool rendered = false;
  };
  struct Rendered {
    render::Frame frame;
    CameraInUse camera;
    telemetry::Stages stages;
    bool still = false;
    uint64_t settings_change = 0;
    std::optional<v1::Decision> decision;
    std::optional<render::ErrorBelief> error;
  };
  struct Encoded {
    v1::ServerMessage message;
    telemetry::Stages stages;
    render::FrameStats stats;
    uint32_t dropped_before = 0;
    int jpeg_quality = 0;
    uint64_t settings_change = 0;
    Clock::time_point since{};
  };

  ViewerStream(const StreamEnvironment& environment, grpc::CallbackServerContext& context);

  Outcome<void> admit();
  // Messages of the client. A failure ends the stream with its status.
  Outcome<void> receive(const v1::ViewerMessage& message);
  Outcome<void> hello(const v1::Hello& hello);
  Outcome<void> camera(const v1::Camera& camera);
  Outcome<void> settings(const v1::Settings& settings);
  void acknowledge(const v1::Ack& ack);

  // Below: with mutex_ held.
  void steer();
  std::optional<v1::Decision> steeredBy(const render::FrameStats& stats);
  void pump();
  void startEncoding(stream::Mailbox<Rendered>::Taken taken);
  void write(v1::ServerMessage message);
  void writeFrame();
  void finish(grpc::Status status);
  Clock::duration maxLatency() const { return std::chrono::milliseconds(settings_.max_latency_ms); }

  void encode(stream::JpegEncoder& encoder, Rendered rendered, int quality, Clock::duration waited,
              uint32_t dropped_before);
  void leave(std::chrono::seconds keep = {});
  std::chrono::seconds patience() const { return std::chrono::seconds(environment_.limits->resume_seconds); }
  std::string keyOf(const std::string& resume_token) const;

  const StreamEnvironment& environment_;
  grpc::CallbackServerContext& context_;
  std::shared_ptr<ViewerStream> self_;  ///< until OnDone
  v1::ViewerMessage in_;
  WorldPtr world_;  ///< set by Hello, once, before anything else runs
  ViewerPlace place_;
  Caller caller_;
  AccessControl::Session session_;

  mutable std::mutex mutex_;
  uint64_t id_ = 0;
  std::string resume_token_;
  bool welcomed_ = false;  ///< frames may follow
  uint64_t unknown_messages_ = 0;
  ViewerSettings settings_;
  uint64_t settings_change_ = 0;  ///< counts changes: frames of earlier settings are let go
  uint64_t change_in_tick_ = 0;
  CameraInUse camera_;
  CameraInUse in_tick_;
  render::ViewSettings view_in_tick_;
  std::optional<render::Controller> controller_;  ///< with a goal
  Capture capture_;                               ///< of the next picture
  Clock::time_point tick_started_{};
  Clock::time_point next_frame_{};

  stream::Mailbox<Rendered> mailbox_;
  stream::AckWindow window_;
  stream::RateControl rate_;
  bool encoding_ = false;
  std::optional<Encoded> encoded_;
  uint64_t last_frame_ = 0;

  std::optional<v1::ServerMessage> welcome_, settings_answer_, notice_;  ///< wait for the write in flight
  std::optional<Failure> ending_;  ///< finish with this as soon as the notice is out
  bool half_closed_ = false;       ///< the client will say nothing more: finish
  bool finished_ = false;
  bool writing_ = false;
  v1::ServerMessage out_;
  Clock::time_point write_started_{};
  Clock::duration previous_write_{};
  telemetry::ViewerCounters counters_;
};

}  // namespace helio::service
