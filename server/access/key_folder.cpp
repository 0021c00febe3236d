#include "access/key_folder.h"

#include <spdlog/fmt/fmt.h>

#include "access/private_file.h"

namespace helio::access {
namespace {

Error notInitialised(const std::filesystem::path& folder) {
  return {ErrorKind::not_found,
          fmt::format("{0} holds no keys of a server; make them with heliographd init --keys {0}", folder.string()),
          "keys",
          folder.string(),
          {}};
}

}  // namespace

Result<void> KeyFolder::create(const std::vector<std::string>& hosts) const {
  if (std::filesystem::exists(authorityKey()) || std::filesystem::exists(authorityCertificate()))
    return Error{ErrorKind::conflict,
                 fmt::format("{} holds the keys of a server already; --renew makes it another certificate, --new-token "
                             "another admin token",
                             folder_.string()),
                 "keys",
                 folder_.string(),
                 {}};
  const auto authority = makeAuthority("Heliograph authority");
  if (!authority) return authority.error();
  const auto server = makeServerCertificate(*authority, hosts);
  if (!server) return server.error();
  // The authority's certificate last: with it the folder counts as made.
  for (const auto& [path, bytes] :
       {std::pair(authorityKey(), authority->key), std::pair(key(), server->key),
        std::pair(certificate(), server->certificate), std::pair(authorityCertificate(), authority->certificate)})
    if (auto written = writePrivateFile(path, bytes); !written) return written;
  return {};
}

Result<void> KeyFolder::renew(const std::vector<std::string>& hosts) const {
  const auto authority_certificate = readFile(authorityCertificate()), authority_key = readFile(authorityKey());
  if (!authority_certificate || !authority_key) return notInitialised(folder_);
  const auto server = makeServerCertificate({*authority_certificate, *authority_key}, hosts);
  if (!server) return server.error();
  // A running server that reads between the two finds a pair that does not fit, and keeps the old one until it does.
  if (auto written = writePrivateFile(key(), server->key); !written) return written;
  return writePrivateFile(certificate(), server->certificate);
}

Result<std::string> KeyFolder::fingerprint() const {
  const auto pem = readFile(authorityCertificate());
  if (!pem) return notInitialised(folder_);
  return fingerprintOf(*pem);
}

Result<void> KeyFolder::check() const {
  const auto authority = readFile(authorityCertificate()), pem = readFile(certificate()), private_key = readFile(key());
  if (!authority || !pem || !private_key) return notInitialised(folder_);
  const auto mend = [&](const std::string& what) {
    return invalid("keys", folder_.string(),
                   fmt::format("{}: {}; mend it with heliographd init --keys {} --renew", folder_.string(), what,
                               folder_.string()));
  };
  if (auto fits = checkIdentity({*pem, *private_key}, *authority); !fits) return mend(fits.error().message);
  const auto facts = inspectCertificate(*pem);
  if (!facts) return mend(facts.error().message);
  const int64_t now = unixTime();
  if (now >= facts->not_after) return mend("the server's certificate has expired");
  if (now < facts->not_before) return mend("the server's certificate is not valid yet: is the clock right?");
  for (const auto& secret : {key(), tokens().path()})
    if (openToOthers(secret))
      return invalid("keys", secret.string(),
                     fmt::format("{0} can be read by others than its owner; chmod 600 {0}", secret.string()));
  if (auto tokens = this->tokens().read(); !tokens) {
    if (tokens.error().kind != ErrorKind::not_found) return tokens.error();
    return invalid("keys", folder_.string(),
                   fmt::format("{} holds no tokens, so nobody could come in; make one with heliographd init --keys {} "
                               "--new-token",
                               folder_.string(), folder_.string()));
  }
  return {};
}

}  // namespace helio::access
