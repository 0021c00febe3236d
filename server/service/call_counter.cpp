#include "service/call_counter.h"

#include <google/protobuf/descriptor.h>

#include <algorithm>
#include <array>
#include <string>

namespace helio::service {
namespace {

using grpc::experimental::InterceptionHookPoints;

/// "/heliograph.v1.WorldService/GetWorld" as "WorldService.GetWorld". Only methods that exist become labels: clients
/// could otherwise make as many as they like.
std::string labelOf(const char* path) {
  std::string name = path ? path : "";
  if (!name.empty()) name.erase(0, 1);
  std::replace(name.begin(), name.end(), '/', '.');
  const std::string package = "heliograph.v1.";
  if (name.compare(0, package.size(), package) != 0 ||
      !google::protobuf::DescriptorPool::generated_pool()->FindMethodByName(name))
    return "other";
  return name.substr(package.size());
}

std::string nameOf(grpc::StatusCode code) {
  static constexpr std::array<const char*, 17> kNames = {
      "OK",        "CANCELLED",      "UNKNOWN",           "INVALID_ARGUMENT",   "DEADLINE_EXCEEDED",
      "NOT_FOUND", "ALREADY_EXISTS", "PERMISSION_DENIED", "RESOURCE_EXHAUSTED", "FAILED_PRECONDITION",
      "ABORTED",   "OUT_OF_RANGE",   "UNIMPLEMENTED",     "INTERNAL",           "UNAVAILABLE",
      "DATA_LOSS", "UNAUTHENTICATED"};
  const auto index = static_cast<size_t>(code);
  return index < kNames.size() ? kNames[index] : "UNKNOWN";
}

class OneCall final : public grpc::experimental::Interceptor {
 public:
  OneCall(telemetry::Metrics& metrics, std::string method) : metrics_(metrics), method_(std::move(method)) {}

  void Intercept(grpc::experimental::InterceptorBatchMethods* methods) override {
    if (methods->QueryInterceptionHookPoint(InterceptionHookPoints::PRE_SEND_STATUS))
      metrics_.called(method_, nameOf(methods->GetSendStatus().error_code()));
    methods->Proceed();
  }

 private:
  telemetry::Metrics& metrics_;
  const std::string method_;
};

}  // namespace

grpc::experimental::Interceptor* CallCounter::CreateServerInterceptor(grpc::experimental::ServerRpcInfo* info) {
  return new OneCall(metrics_, labelOf(info->method()));
}

}  // namespace helio::service
