// Result<T>: a value, or an error for people. (std::expected is C++23, and the clang tools of Debian 12 cannot read
// it.)
#pragma once

#include <string>
#include <utility>
#include <variant>

namespace helio {

/// What went wrong, in words that `service/` can map to a gRPC status without reading the text.
enum class ErrorKind {
  invalid,      ///< a field is wrong: INVALID_ARGUMENT
  not_found,    ///< a name or id that does not exist: NOT_FOUND
  limit,        ///< a limit or a memory budget: RESOURCE_EXHAUSTED
  conflict,     ///< an expectation about state does not hold: ABORTED
  unsupported,  ///< well-formed, but needs something that this build or device does not have: FAILED_PRECONDITION
  unavailable,  ///< loading, draining, elsewhere: UNAVAILABLE
  damaged,      ///< what was stored does not read back as it was written: DATA_LOSS
  internal,     ///< our own fault: INTERNAL
};

/// One line: what was wrong, with which value, what to do. `field` names the input, if there was one.
struct Error {
  ErrorKind kind = ErrorKind::internal;
  std::string message;
  std::string field;
  std::string value;
  std::string limit;
};

inline Error invalid(std::string field, std::string value, std::string message) {
  return {ErrorKind::invalid, std::move(message), std::move(field), std::move(value), {}};
}

/// Either a T or an E. `[[nodiscard]]`: an ignored Result is a bug. (Only service/ has an E of its own: what clients
/// may learn beside the Error.)
template <typename T, typename E = Error>
class [[nodiscard]] Result {
 public:
  Result(T value) : state_(std::in_place_index<0>, std::move(value)) {}
  Result(E error) : state_(std::in_place_index<1>, std::move(error)) {}

  bool ok() const { return state_.index() == 0; }
  explicit operator bool() const { return ok(); }
  T& value() { return std::get<0>(state_); }
  const T& value() const { return std::get<0>(state_); }
  T& operator*() { return value(); }
  const T& operator*() const { return value(); }
  T* operator->() { return &value(); }
  const T* operator->() const { return &value(); }
  const E& error() const { return std::get<1>(state_); }

 private:
  std::variant<T, E> state_;
};

template <typename E>
class [[nodiscard]] Result<void, E> {
 public:
  Result() = default;
  Result(E error) : error_(std::move(error)), failed_(true) {}

  bool ok() const { return !failed_; }
  explicit operator bool() const { return ok(); }
  const E& error() const { return error_; }

 private:
  E error_;
  bool failed_ = false;
};

}  // namespace helio
