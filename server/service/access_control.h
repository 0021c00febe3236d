// Who calls, whether they may, and until when.
#pragma once

#include <grpcpp/server_context.h>

#include <heliograph/v1/access.pb.h>

#include <condition_variable>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "access/key_folder.h"
#include "service/failure.h"

namespace helio::service {

/// Who calls. Without a token: a server without keys, which only listens on loopback, and everything is allowed.
struct Caller {
  std::optional<access::Token> token;

  bool mayUse(const std::string& world) const {
    return !token || token->worlds.empty() || token->worlds.count(world) != 0;
  }
  bool boundToWorlds() const { return token && !token->worlds.empty(); }
};

/// Thread-safe. What a method needs stands in its proto (`needs`); one that says nothing is refused to everybody.
class AccessControl {
 public:
  /// Nobody is asked for a token.
  AccessControl() = default;
  /// The tokens of a folder. Its file is looked at again every second: what changed there holds without a restart. A
  /// file that cannot be read any more changes nothing, and is logged. Errors: KeyFolder::check().
  static Result<std::unique_ptr<AccessControl>> open(const access::KeyFolder& folder);
  ~AccessControl();

  /// `method`: "WorldService.ApplyEdits". Failures: no good token (unauthenticated); scope, a method about the whole
  /// server for a token that is bound to worlds (forbidden); the call's deadline is over.
  Outcome<Caller> admit(const grpc::ServerContextBase& context, const std::string& method) const;
  /// Likewise for a call whose request is known; also checks its field `world`, which must be named if the caller is
  /// bound to worlds.
  Outcome<Caller> admit(const grpc::ServerContextBase& context, const std::string& method,
                        const google::protobuf::Message& request) const;

  /// Failure unless the caller may use this world.
  static Outcome<void> checkWorld(const Caller& caller, const std::string& world);

  /// Given back when a stream is over.
  using Session = std::shared_ptr<void>;
  /// How a stream is ended: first in order; if it is still there two seconds later (its client reads nothing), at once.
  using End = std::function<void(const Failure& why, bool at_once)>;
  /// A stream begins. `end` is called, from another thread, when the caller's token is revoked, has expired or has
  /// become weaker; never after the session was given back.
  Session enter(const Caller& caller, End end);

  /// The file of the tokens; none: there are none.
  const std::optional<access::TokenFile>& tokens() const { return file_; }
  /// Reads the file again, now, and ends the streams that it no longer allows.
  void reload();

 private:
  struct OpenStream {
    access::Token token;
    End end;
    std::optional<std::chrono::steady_clock::time_point> ended{};  ///< when it was told to
  };

  explicit AccessControl(const access::KeyFolder& folder) : file_(folder.tokens()) {}
  Outcome<Caller> identify(const grpc::ServerContextBase& context) const;
  void endRevoked();
  void watch();

  std::optional<access::TokenFile> file_;

  mutable std::mutex mutex_;
  std::vector<access::Token> tokens_;
  std::optional<std::string> complaint_;  ///< about the file, as it was logged last

  struct Streams {
    std::mutex mutex;
    std::map<uint64_t, OpenStream> open;
    uint64_t next = 1;
  };
  std::shared_ptr<Streams> streams_ = std::make_shared<Streams>();  ///< sessions may outlive this object

  std::mutex stop_mutex_;
  std::condition_variable stop_;
  bool stopping_ = false;
  std::thread watcher_;
};

}  // namespace helio::service
