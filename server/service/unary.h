// One call, one answer: who calls is checked first, then the work is done, at once.
#pragma once

#include <grpcpp/grpcpp.h>

#include <string>

#include "service/access_control.h"

namespace helio::service {

/// `work` gets the Caller and returns an Outcome<void>.
template <typename Request, typename Work>
grpc::ServerUnaryReactor* unary(const AccessControl& access, grpc::CallbackServerContext& context,
                                const std::string& method, const Request& request, Work work) {
  auto* reactor = context.DefaultReactor();
  const auto caller = access.admit(context, method, request);
  const Outcome<void> outcome = caller ? work(*caller) : Outcome<void>(caller.error());
  reactor->Finish(outcome ? grpc::Status::OK : toStatus(outcome.error(), context));
  return reactor;
}

}  // namespace helio::service
