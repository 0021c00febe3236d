#include "daemon/init.h"

#include <spdlog/fmt/fmt.h>
#include <unistd.h>

#include <algorithm>

#include "access/key_folder.h"
#include "access/private_file.h"

namespace helio::daemon {
namespace {

/// What was asked for first: clients use it. Then what always leads here.
std::vector<std::string> hostsOf(std::vector<std::string> hosts) {
  char name[256] = "";
  gethostname(name, sizeof name - 1);
  for (const std::string& usual :
       {std::string("localhost"), std::string("127.0.0.1"), std::string("::1"), std::string(name)})
    if (!usual.empty() && std::find(hosts.begin(), hosts.end(), usual) == hosts.end()) hosts.push_back(usual);
  return hosts;
}

/// Where clients find the server: the first host that was named, now or for the certificate, at the port that it
/// listens on.
Result<std::string> addressFor(const Configuration& configuration, const InitOptions& options,
                               const access::KeyFolder& folder) {
  std::vector<std::string> hosts = options.hosts;
  if (hosts.empty()) {
    const auto pem = access::readFile(folder.certificate());
    if (!pem) return pem.error();
    auto certificate = access::inspectCertificate(*pem);
    if (!certificate) return certificate.error();
    hosts = std::move(certificate->hosts);
  }
  const std::string host = hosts.empty() ? "localhost" : hosts.front();
  const std::string& listen = configuration.server.address;
  const std::string port = listen.substr(listen.rfind(':') + 1);
  return (host.find(':') == std::string::npos ? host : "[" + host + "]") + ":" + port;
}

}  // namespace

Result<std::string> initialise(const Configuration& configuration, const InitOptions& options) {
  if (configuration.server.keys.empty())
    return invalid("keys", "", "say where the keys shall be: heliographd init --keys FOLDER");
  const access::KeyFolder folder(configuration.server.keys);
  if (options.renew) {
    if (auto renewed = folder.renew(hostsOf(options.hosts)); !renewed) return renewed.error();
    if (!options.new_token) return std::string();
  } else if (!options.new_token) {
    if (auto created = folder.create(hostsOf(options.hosts)); !created) return created.error();
  }
  const auto fingerprint = folder.fingerprint();
  if (!fingerprint) return fingerprint.error();
  const auto address = addressFor(configuration, options, folder);
  if (!address) return address.error();
  const auto token = folder.tokens().create({"admin", access::Scope::admin, {}, 0});
  if (!token) return token.error();
  return fmt::format("helio login {} --ca-sha256 {} --token {}", *address, *fingerprint, token->text);
}

}  // namespace helio::daemon
