#include "access/private_file.h"

#include <fcntl.h>
#include <spdlog/fmt/fmt.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>

namespace helio::access {

namespace fs = std::filesystem;

namespace {

Error cannot(const char* what, const fs::path& path) {
  return invalid("file", path.string(), fmt::format("cannot {} {}: {}", what, path.string(), std::strerror(errno)));
}

bool writeAll(int file, const std::string& bytes) {
  size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t written = ::write(file, bytes.data() + done, bytes.size() - done);
    if (written < 0 && errno != EINTR) return false;
    if (written > 0) done += static_cast<size_t>(written);
  }
  return true;
}

void syncFolder(const fs::path& folder) {
  if (const int file = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC); file >= 0) {
    ::fsync(file);
    ::close(file);
  }
}

}  // namespace

Result<void> writePrivateFile(const fs::path& path, const std::string& bytes) {
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  std::error_code error;
  if (fs::create_directories(folder, error)) fs::permissions(folder, fs::perms::owner_all, error);
  std::string name = path.string() + ".XXXXXX";
  const int file = ::mkostemp(name.data(), O_CLOEXEC);  // with mode 0600
  if (file < 0) return cannot("write", path);
  const bool written = writeAll(file, bytes) && ::fsync(file) == 0;
  const int why = errno;
  ::close(file);
  errno = why;
  if (!written || ::rename(name.c_str(), path.c_str()) != 0) {
    auto failed = cannot("write", path);
    ::unlink(name.c_str());
    return failed;
  }
  syncFolder(folder);
  return {};
}

Result<std::string> readFile(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    auto failed = cannot("read", path);
    if (errno == ENOENT) failed.kind = ErrorKind::not_found;
    return failed;
  }
  std::stringstream bytes;
  bytes << file.rdbuf();
  return bytes.str();
}

bool openToOthers(const fs::path& path) {
  struct stat status {};
  return ::stat(path.c_str(), &status) == 0 && (status.st_mode & (S_IRWXG | S_IRWXO)) != 0;
}

FolderLock::FolderLock(const fs::path& folder) : folder_(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
  if (folder_ >= 0)
    while (::flock(folder_, LOCK_EX) != 0 && errno == EINTR) {}
}

FolderLock::~FolderLock() {
  if (folder_ >= 0) ::close(folder_);
}

}  // namespace helio::access
