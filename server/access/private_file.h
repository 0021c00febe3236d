// Files with secrets: for their owner alone, and whole at every moment.
#pragma once

#include <filesystem>
#include <string>

#include "base/result.h"

namespace helio::access {

/// Replaces `path` in one step by a file with mode 0600, synced to the disk; makes its folder (mode 0700) if it is not
/// there. Errors: the system's (invalid), which leave what was there.
Result<void> writePrivateFile(const std::filesystem::path& path, const std::string& bytes);

/// The whole file. Errors: it is not there (not_found), the system's (invalid).
Result<std::string> readFile(const std::filesystem::path& path);

/// Whether others than its owner may read or change it.
bool openToOthers(const std::filesystem::path& path);

/// Keeps other processes that lock the same folder out, as long as it lives.
class FolderLock {
 public:
  explicit FolderLock(const std::filesystem::path& folder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int folder_;
};

}  // namespace helio::access
