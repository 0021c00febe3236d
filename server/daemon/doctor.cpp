#include "daemon/doctor.h"

#include <netdb.h>
#include <spdlog/fmt/fmt.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "access/key_folder.h"
#include "access/private_file.h"
#include "daemon/ops_port.h"
#include "gpu/device.h"
#include "store/log_folder.h"
#include "store/sqlite_edit_log.h"

namespace helio::daemon {
namespace {

using Grade = Finding::Grade;

constexpr double kGiB = 1024.0 * 1024.0 * 1024.0;
constexpr double kLittleMemory = 4 * kGiB;       // a city of 10,000 instances at 720p takes 1 to 2 GiB of each kind
constexpr double kLittleDisk = 1 * kGiB;         // some ten million edits
constexpr int64_t kSoon = int64_t{30} * 86'400;  // seconds in which a certificate should be renewed

Finding device(const Configuration& configuration) {
  if (configuration.renderer == "synthetic")
    return {"device", Grade::good, "none is needed by the synthetic renderer", ""};
  auto device = gpu::Device::create({configuration.device.device, configuration.device.validation});
  // The message lists the devices that are there, and says what they lack.
  if (!device)
    return {
        "device", Grade::bad, device.error().message,
        "install a Vulkan driver with ray tracing pipelines (mesa-vulkan-drivers 24.1 or newer has one for the CPU)"};
  const VkPhysicalDeviceMemoryProperties* memory = nullptr;
  vmaGetMemoryProperties((*device)->allocator(), &memory);
  VkDeviceSize local = 0;
  for (uint32_t i = 0; i < memory->memoryHeapCount; ++i)
    if (memory->memoryHeaps[i].flags & VK_MEMORY_HEAP_DEVICE_LOCAL_BIT)
      local = std::max(local, memory->memoryHeaps[i].size);
  const auto found = fmt::format("{} ({}), ray tracing pipelines, {:.1f} GiB", (*device)->name(), (*device)->driver(),
                                 double(local) / kGiB);
  if (double(local) < kLittleMemory)
    return {"device", Grade::warning, found, "keep worlds small (--max-instances) or choose another --device"};
  if ((*device)->cpu())
    return {"device", Grade::warning, found + "; it is software: expect about a frame a second",
            "for speed, a GPU with ray tracing and its driver; --device gpu insists on one"};
  return {"device", Grade::good, found, ""};
}

Finding memory() {
  std::ifstream file("/proc/meminfo");
  std::string name, unit;
  double kibibytes = 0;
  while (file >> name >> kibibytes && name != "MemAvailable:") std::getline(file, unit);
  if (name != "MemAvailable:") return {"memory", Grade::warning, "the system does not say how much is free", ""};
  const double bytes = kibibytes * 1024;
  const auto found = fmt::format("{:.1f} GiB are free", bytes / kGiB);
  if (bytes < kLittleMemory)
    return {"memory", Grade::warning, found, "free some, or keep worlds small (--max-instances, --max-worlds)"};
  return {"memory", Grade::good, found, ""};
}

/// Binds a socket to it, and lets it go again. Empty: it can be listened on.
std::string whyNot(const HostAndPort& where) {
  addrinfo hints{}, *list = nullptr;
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = AI_PASSIVE;
  if (const int code = getaddrinfo(where.host.c_str(), std::to_string(where.port).c_str(), &hints, &list); code != 0)
    return gai_strerror(code);
  std::string why;
  const int socket = ::socket(list->ai_family, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const int yes = 1;
  if (socket >= 0) setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  if (socket < 0 || ::bind(socket, list->ai_addr, list->ai_addrlen) != 0 || ::listen(socket, 1) != 0)
    why = std::strerror(errno);
  if (socket >= 0) ::close(socket);
  freeaddrinfo(list);
  return why;
}

Finding port(const std::string& check, const std::string& flag, const std::string& address) {
  const auto where = parseAddress(flag, address);
  if (!where) return {check, Grade::bad, where.error().message, ""};
  if (const auto why = whyNot(*where); !why.empty())
    return {check, Grade::bad, fmt::format("{} cannot be listened on: {}", address, why),
            fmt::format("end what listens there (another heliographd?), or choose another --{}", flag)};
  return {check, Grade::good, address + " is free", ""};
}

Finding logFolder(const std::string& folder) {
  const std::string check = "log folder";
  if (folder.empty())
    return {check, Grade::warning, "none: worlds end with the server", "keep them with --log-dir FOLDER"};
  if (auto prepared = store::prepareLogFolder(folder); !prepared)
    return {check, Grade::bad, prepared.error().message, "choose another --log-dir, on a local disk"};
  if (::access(folder.c_str(), R_OK | W_OK | X_OK) != 0)
    return {check, Grade::bad, folder + ": " + std::strerror(errno),
            "give the folder to the user that runs heliographd (chown)"};
  std::error_code error;
  if (!std::filesystem::is_empty(folder, error)) {
    store::SqliteLogOptions options;
    options.folder = folder;
    if (auto log = store::openSqliteEditLog(std::move(options)); !log)
      return {check, Grade::bad, log.error().message,
              "end the server that uses it; if it is damaged, helio worlds repair or a copy"};
  }
  const auto space = std::filesystem::space(folder, error);
  const auto found = fmt::format("{}: {:.1f} GiB are free", folder, double(space.available) / kGiB);
  if (!error && double(space.available) < kLittleDisk)
    return {check, Grade::warning, found, "free some: edits fail when the disk is full"};
  return {check, Grade::good, found, ""};
}

Finding keys(const Configuration& configuration) {
  const std::string check = "keys";
  const auto& folder = configuration.server.keys;
  if (folder.empty()) {
    if (service::isLoopback(configuration.server.address))
      return {check, Grade::good, "none are needed on loopback: whoever is on this machine may do everything", ""};
    return {check, Grade::bad, "none, and " + configuration.server.address + " is not loopback",
            "heliographd init --keys FOLDER, then start with --keys FOLDER"};
  }
  const access::KeyFolder keys(folder);
  if (auto good = keys.check(); !good) return {check, Grade::bad, good.error().message, ""};
  const auto facts = access::inspectCertificate(*access::readFile(keys.certificate()));
  const auto tokens = keys.tokens().read();
  if (!facts || !tokens) return {check, Grade::bad, folder.string() + " changes while it is read", "try again"};
  std::string hosts;
  for (const auto& host : facts->hosts) hosts += (hosts.empty() ? "" : ", ") + host;
  const int64_t left = facts->not_after - access::unixTime();
  const auto found = fmt::format("{}: certificate for {}, {} more days; {} tokens", folder.string(), hosts,
                                 left / 86'400, tokens->size());
  if (left < kSoon)
    return {check, Grade::warning, found, fmt::format("heliographd init --keys {} --renew", folder.string())};
  if (tokens->empty())
    return {check, Grade::bad, found, fmt::format("heliographd init --keys {} --new-token", folder.string())};
  return {check, Grade::good, found, ""};
}

const char* nameOf(Grade grade) {
  switch (grade) {
    case Grade::good:
      return "good";
    case Grade::warning:
      return "warning";
    case Grade::bad:
      return "bad";
  }
  return "bad";
}

}  // namespace

std::vector<Finding> examine(const Configuration& configuration) {
  std::vector<Finding> findings = {device(configuration), memory(),
                                   port("port", "listen", configuration.server.address)};
  if (!configuration.ops_address.empty()) findings.push_back(port("ops port", "ops-listen", configuration.ops_address));
  findings.push_back(logFolder(configuration.log_folder));
  findings.push_back(keys(configuration));
  return findings;
}

std::string report(const std::vector<Finding>& findings, bool json) {
  if (json) {
    nlohmann::ordered_json document = {
        {"schema", "heliograph.doctor/1"}, {"can_serve", canServe(findings)}, {"findings", nlohmann::json::array()}};
    for (const auto& f : findings)
      document["findings"].push_back(
          {{"check", f.check}, {"grade", nameOf(f.grade)}, {"found", f.found}, {"mend", f.mend}});
    return document.dump(2) + "\n";
  }
  std::string text;
  for (const auto& f : findings) {
    text += fmt::format("{:<8} {:<10} {}\n", nameOf(f.grade), f.check, f.found);
    if (!f.mend.empty()) text += fmt::format("{:<19} -> {}\n", "", f.mend);
  }
  return text;
}

bool canServe(const std::vector<Finding>& findings) {
  return std::none_of(findings.begin(), findings.end(), [](const Finding& f) { return f.grade == Grade::bad; });
}

}  // namespace helio::daemon
