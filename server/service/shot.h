// One still picture: accumulates on the world's thread like a viewer, encodes, and streams the file.
#pragma once

#include <heliograph/v1/render.grpc.pb.h>

#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "service/viewer_stream.h"

namespace helio::service {

class Shot final : public grpc::ServerWriteReactor<v1::RenderEvent>,
                   public ViewSink,
                   public std::enable_shared_from_this<Shot> {
 public:
  /// Lives until gRPC is done with it and nobody else holds it.
  static Shot* open(const StreamEnvironment& environment, grpc::CallbackServerContext& context,
                    const v1::RenderRequest& request);

  void OnWriteDone(bool ok) override;
  void OnCancel() override;
  void OnDone() override;

  std::optional<Clock::time_point> wantedFrom(Clock::time_point now) override;
  ViewDemand demand(Clock::time_point now) override;
  void deliver(render::Frame frame, Clock::duration tick) override;
  void end(const Failure& failure) override;

 private:
  Shot(const StreamEnvironment& environment, grpc::CallbackServerContext& context);
  Outcome<void> begin(const v1::RenderRequest& request);
  void encode(stream::JpegEncoder& encoder, render::Frame frame);
  void leave();

  // Below: with mutex_ held.
  void pump();
  void finish(grpc::Status status);

  const StreamEnvironment& environment_;
  grpc::CallbackServerContext& context_;
  std::shared_ptr<Shot> self_;  ///< until OnDone
  WorldPtr world_;              ///< set by begin(), before anything else runs
  ViewerPlace place_;
  AccessControl::Session session_;
  ShotSettings settings_;
  scene::Camera camera_;

  std::mutex mutex_;
  uint32_t ticks_ = 0;
  double gpu_ms_ = 0;
  render::Rays rays_;
  bool rendered_ = false;                    ///< enough samples: no more ticks
  std::optional<v1::RenderEvent> progress_;  ///< the newest, waiting for the write in flight
  std::optional<v1::RenderEvent> header_;
  std::string file_;
  size_t sent_ = 0;
  bool encoded_ = false;
  std::optional<Failure> ending_;
  bool gone_ = false, finished_ = false, writing_ = false;
  v1::RenderEvent out_;
};

}  // namespace helio::service
