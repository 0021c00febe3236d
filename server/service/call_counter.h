// Counts every call by method and status, whoever answers it.
#pragma once

#include <grpcpp/support/server_interceptor.h>

#include "telemetry/metrics.h"

namespace helio::service {

/// `metrics` outlives the server.
class CallCounter final : public grpc::experimental::ServerInterceptorFactoryInterface {
 public:
  explicit CallCounter(telemetry::Metrics& metrics) : metrics_(metrics) {}
  grpc::experimental::Interceptor* CreateServerInterceptor(grpc::experimental::ServerRpcInfo* info) override;

 private:
  telemetry::Metrics& metrics_;
};

}  // namespace helio::service
