// Why a call fails, and the one place where that becomes a gRPC status.
#pragma once

#include <grpcpp/server_context.h>
#include <grpcpp/support/status.h>

#include <heliograph/v1/error.pb.h>

#include <string>

#include "base/result.h"

namespace helio::service {

namespace v1 = heliograph::v1;

/// An Error with what only clients need: the reason, and when to try again.
struct Failure {
  Failure() = default;
  /// The reason follows from the kind.
  Failure(Error error);
  Failure(v1::ErrorReason reason, Error error, uint32_t retry_after_ms = 0);

  v1::ErrorReason reason = v1::ERROR_REASON_INTERNAL;
  Error error;
  uint32_t retry_after_ms = 0;
};

template <typename T>
using Outcome = Result<T, Failure>;

/// The status; puts the ErrorDetail into the call's trailing metadata. Call it at most once a call, before it finishes.
grpc::Status toStatus(const Failure& failure, grpc::ServerContextBase& context);

// The failures that several services share.
Failure unknownWorld(const std::string& world);
Failure worldDeleted(const std::string& world);
Failure draining();
Failure superseded();
Failure moved(const std::string& world);
Failure fellSilent(uint32_t seconds);
/// A call's deadline was over before its work was begun.
Failure tooLate();
/// A single field out of range.
Failure outOfRange(std::string field, std::string value, std::string limit);
/// A limit of the whole server or world.
Failure beyondLimit(std::string field, std::string value, std::string limit, std::string message);

}  // namespace helio::service
