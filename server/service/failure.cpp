#include "service/failure.h"

#include <utility>

namespace helio::service {
namespace {

v1::ErrorReason reasonOf(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::invalid:
      return v1::ERROR_REASON_INVALID_FIELD;
    case ErrorKind::not_found:
      return v1::ERROR_REASON_UNKNOWN_NAME;
    case ErrorKind::limit:
      return v1::ERROR_REASON_LIMIT;
    case ErrorKind::conflict:
      return v1::ERROR_REASON_SEQ_MISMATCH;
    case ErrorKind::unsupported:
      return v1::ERROR_REASON_UNSUPPORTED;
    case ErrorKind::unavailable:
      return v1::ERROR_REASON_UNAVAILABLE;
    case ErrorKind::damaged:
      return v1::ERROR_REASON_DATA_LOSS;
    case ErrorKind::internal:
      return v1::ERROR_REASON_INTERNAL;
  }
  return v1::ERROR_REASON_INTERNAL;
}

grpc::StatusCode codeOf(v1::ErrorReason reason) {
  switch (reason) {
    case v1::ERROR_REASON_INVALID_FIELD:
      return grpc::StatusCode::INVALID_ARGUMENT;
    case v1::ERROR_REASON_UNKNOWN_WORLD:
    case v1::ERROR_REASON_UNKNOWN_NAME:
    case v1::ERROR_REASON_WORLD_DELETED:
      return grpc::StatusCode::NOT_FOUND;
    case v1::ERROR_REASON_WORLD_EXISTS:
      return grpc::StatusCode::ALREADY_EXISTS;
    case v1::ERROR_REASON_LIMIT:
      return grpc::StatusCode::RESOURCE_EXHAUSTED;
    case v1::ERROR_REASON_SEQ_MISMATCH:
    case v1::ERROR_REASON_SUPERSEDED:
      return grpc::StatusCode::ABORTED;
    case v1::ERROR_REASON_WORLD_FAILED:
    case v1::ERROR_REASON_UNSUPPORTED:
      return grpc::StatusCode::FAILED_PRECONDITION;
    case v1::ERROR_REASON_DATA_LOSS:
      return grpc::StatusCode::DATA_LOSS;
    case v1::ERROR_REASON_UNAUTHENTICATED:
      return grpc::StatusCode::UNAUTHENTICATED;
    case v1::ERROR_REASON_FORBIDDEN:
      return grpc::StatusCode::PERMISSION_DENIED;
    case v1::ERROR_REASON_TOO_LATE:
      return grpc::StatusCode::DEADLINE_EXCEEDED;
    case v1::ERROR_REASON_WORLD_LOADING:
    case v1::ERROR_REASON_DRAINING:
    case v1::ERROR_REASON_FENCED:
    case v1::ERROR_REASON_OUTCOME_UNKNOWN:
    case v1::ERROR_REASON_UNAVAILABLE:
    case v1::ERROR_REASON_SILENT:
      return grpc::StatusCode::UNAVAILABLE;
    default:
      return grpc::StatusCode::INTERNAL;
  }
}

// Long enough for a supervisor to have started the server again.
constexpr uint32_t kDrainRetryMs = 2000;
// The other server has to load the world first.
constexpr uint32_t kMovedRetryMs = 1000;

}  // namespace

Failure::Failure(Error e) : reason(reasonOf(e.kind)), error(std::move(e)) {}

Failure::Failure(v1::ErrorReason r, Error e, uint32_t retry) : reason(r), error(std::move(e)), retry_after_ms(retry) {}

grpc::Status toStatus(const Failure& failure, grpc::ServerContextBase& context) {
  v1::ErrorDetail detail;
  detail.set_reason(failure.reason);
  detail.set_field(failure.error.field);
  detail.set_value(failure.error.value);
  detail.set_limit(failure.error.limit);
  detail.set_retry_after_ms(failure.retry_after_ms);
  context.AddTrailingMetadata("heliograph-error-bin", detail.SerializeAsString());
  return {codeOf(failure.reason), failure.error.message};
}

Failure unknownWorld(const std::string& world) {
  return {v1::ERROR_REASON_UNKNOWN_WORLD,
          {ErrorKind::not_found,
           "there is no world \"" + world + "\" here; list the worlds to see their names",
           "world",
           world,
           {}}};
}

Failure worldDeleted(const std::string& world) {
  return {v1::ERROR_REASON_WORLD_DELETED,
          {ErrorKind::not_found, "world \"" + world + "\" was deleted", "world", world, {}}};
}

Failure draining() {
  return {v1::ERROR_REASON_DRAINING,
          {ErrorKind::unavailable, "the server is going down; connect again in a moment", {}, {}, {}},
          kDrainRetryMs};
}

Failure superseded() {
  return {v1::ERROR_REASON_SUPERSEDED,
          {ErrorKind::conflict, "another connection has gone on with this viewer", {}, {}, {}}};
}

Failure moved(const std::string& world) {
  return {v1::ERROR_REASON_FENCED,
          {ErrorKind::unavailable,
           "another server has taken world \"" + world + "\" over; ask where it is",
           "world",
           world,
           {}},
          kMovedRetryMs};
}

Failure fellSilent(uint32_t seconds) {
  return {v1::ERROR_REASON_SILENT,
          {ErrorKind::unavailable,
           "no frame was acknowledged for " + std::to_string(seconds) + " s; attach again",
           {},
           {},
           std::to_string(seconds) + " s"}};
}

Failure tooLate() {
  return {v1::ERROR_REASON_TOO_LATE,
          {ErrorKind::unavailable, "the call's deadline was over before it was begun; nothing was done", {}, {}, {}}};
}

Failure outOfRange(std::string field, std::string value, std::string limit) {
  std::string message = field + " is " + value + "; it must be in " + limit;
  return Error{ErrorKind::invalid, std::move(message), std::move(field), std::move(value), std::move(limit)};
}

Failure beyondLimit(std::string field, std::string value, std::string limit, std::string message) {
  return Error{ErrorKind::limit, std::move(message), std::move(field), std::move(value), std::move(limit)};
}

}  // namespace helio::service
