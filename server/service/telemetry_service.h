// Samples of what the server does, one stream a watcher.
#pragma once

#include <heliograph/v1/telemetry.grpc.pb.h>

#include <set>

#include "service/access_control.h"
#include "service/world_registry.h"

namespace helio::service {

class TelemetryService final : public v1::TelemetryService::CallbackService {
 public:
  TelemetryService(WorldRegistry& worlds, AccessControl& access) : worlds_(worlds), access_(access) {}

  grpc::ServerWriteReactor<v1::TelemetrySample>* Watch(grpc::CallbackServerContext* context,
                                                       const v1::WatchTelemetryRequest* request) override;

  /// Ends every watch; new ones fail.
  void drain();

 private:
  class Watcher;

  WorldRegistry& worlds_;
  AccessControl& access_;
  const Clock::time_point started_ = Clock::now();
  std::mutex mutex_;
  std::set<Watcher*> watchers_;
  bool draining_ = false;
};

}  // namespace helio::service
