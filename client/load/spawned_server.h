// heliographd as a process of its own, for as long as the object lives.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "base/result.h"

namespace helio::load {

class SpawnedServer {
 public:
  /// `program` with `flags`, on a free port of loopback; waits until it is ready. What it says goes to a file. Errors
  /// (unavailable): its last line.
  static Result<std::unique_ptr<SpawnedServer>> start(const std::string& program, std::vector<std::string> flags);
  /// Ends it in order; after 10 s without an answer at once.
  ~SpawnedServer();

  const std::string& address() const { return address_; }
  /// At once, from any thread.
  void kill();

 private:
  SpawnedServer() = default;
  std::string lastLine() const;

  std::filesystem::path folder_;
  std::string address_;
  pid_t pid_ = 0;
};

}  // namespace helio::load
