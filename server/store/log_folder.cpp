#include "store/log_folder.h"

#include <spdlog/fmt/fmt.h>
#include <sys/stat.h>
#include <sys/statfs.h>

#include <cerrno>
#include <cstring>
#include <utility>

namespace helio::store {

namespace fs = std::filesystem;

std::optional<std::string> networkFileSystem(long type) {
  // statfs(2); linux/magic.h lacks some of them.
  constexpr std::pair<unsigned long, const char*> kNetwork[] = {
      {0x6969, "NFS"},      {0x517b, "SMB"},       {0xfe534d42, "SMB2"},  {0xff534d42, "CIFS"}, {0x5346414f, "AFS"},
      {0x6b414653, "kAFS"}, {0x73757245, "Coda"},  {0x564c, "NCP"},       {0x00c36400, "Ceph"}, {0x0bd00bd0, "Lustre"},
      {0x01161970, "GFS2"}, {0x7461636f, "OCFS2"}, {0x19830326, "FhGFS"}, {0x47504653, "GPFS"}};
  for (const auto& [magic, name] : kNetwork)
    if ((static_cast<unsigned long>(type) & 0xffffffffu) == magic) return name;
  return std::nullopt;
}

Result<void> prepareLogFolder(const fs::path& folder) {
  const std::string name = folder.string();
  const auto refuse = [&](const std::string& why) {
    return invalid("log-dir", name, fmt::format("log folder {}: {}", name, why));
  };
  std::error_code error;
  const bool made = fs::create_directories(folder, error);
  if (error) return refuse(error.message());
  if (!fs::is_directory(folder, error)) return refuse("is not a folder");
  if (made) fs::permissions(folder, fs::perms::owner_all, error);

  struct statfs system {};
  if (statfs(folder.c_str(), &system) != 0) return refuse(std::strerror(errno));
  return checkFileSystem(name, static_cast<long>(system.f_type));
}

Result<void> checkFileSystem(const std::string& folder, long type) {
  if (const auto network = networkFileSystem(type))
    return Error{ErrorKind::unsupported,
                 fmt::format("log folder {} lies on {}, a network file system, where a sync does not keep what it "
                             "promises; use a local disk",
                             folder, *network),
                 "log-dir", folder, "local file systems"};
  return {};
}

}  // namespace helio::store
