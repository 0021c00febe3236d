// The true error of a live picture: captures one, freezes its world in a copy, lets a reference converge beside the
// ticks, and compares.
#pragma once

#include <heliograph/v1/render.grpc.pb.h>

#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "service/viewer_stream.h"

namespace helio::service {

/// What was asked for, with the defaults filled in.
struct AccuracySettings {
  std::optional<uint64_t> viewer;  ///< whose picture; none: one of our own, by the next three
  ViewerSettings picture;
  scene::Camera camera;
  uint32_t frames = 8;
  uint32_t samples = 256;  ///< of the reference, a pixel; even
  std::optional<uint32_t> bounces;
  bool pictures = false;
};

/// Attached to its world like a viewer, for the picture of its own and to learn of the world's end. The reference has a
/// thread of its own, which ends before the call does.
class AccuracyRun final : public grpc::ServerWriteReactor<v1::AccuracyEvent>,
                          public ViewSink,
                          public std::enable_shared_from_this<AccuracyRun> {
 public:
  /// Lives until gRPC is done with it and nobody else holds it.
  static AccuracyRun* open(const StreamEnvironment& environment, grpc::CallbackServerContext& context,
                           const v1::MeasureAccuracyRequest& request);

  void OnWriteDone(bool ok) override;
  void OnCancel() override;
  void OnDone() override;

  std::optional<Clock::time_point> wantedFrom(Clock::time_point now) override;
  ViewDemand demand(Clock::time_point now) override;
  void deliver(render::Frame frame, Clock::duration tick) override;
  void end(const Failure& failure) override;
  void tend(Clock::time_point now) override;

 private:
  AccuracyRun(const StreamEnvironment& environment, grpc::CallbackServerContext& context)
      : environment_(environment), context_(context) {}
  Outcome<void> begin(const v1::MeasureAccuracyRequest& request);
  Outcome<AccuracySettings> settingsOf(const v1::MeasureAccuracyRequest& request, const HostedWorld& world,
                                       const Caller& caller) const;
  Outcome<void> checkViewer(uint64_t viewer, const HostedWorld& world, const Caller& caller) const;
  Capture captureHere();

  // On the thread of the reference.
  void run();
  Outcome<void> measure();
  std::optional<Captured> awaitPicture();
  bool over();
  void report(uint32_t samples, double relative_mse);

  void leave();
  // Below: with mutex_ held.
  void pump();
  void finish(grpc::Status status);

  const StreamEnvironment& environment_;
  grpc::CallbackServerContext& context_;
  std::shared_ptr<AccuracyRun> self_;  ///< until OnDone
  WorldPtr world_;                     ///< set by begin(), before anything else runs
  ViewerPlace place_;
  std::shared_ptr<void> aside_;
  AccessControl::Session session_;
  AccuracySettings settings_;
  std::thread thread_;

  std::mutex mutex_;
  std::condition_variable wake_;
  uint32_t frames_left_ = 0;
  std::optional<Captured> captured_;
  bool taken_ = false;                         ///< captured_ was there
  std::optional<v1::AccuracyEvent> progress_;  ///< the newest, waiting for the write in flight
  std::deque<v1::AccuracyEvent> events_;       ///< the result and its pictures
  bool measured_ = false;                      ///< they were there
  std::optional<Failure> ending_;
  bool done_ = true;  ///< nothing runs any more: the call may finish
  bool gone_ = false, finished_ = false, writing_ = false;
  v1::AccuracyEvent out_;
};

}  // namespace helio::service
