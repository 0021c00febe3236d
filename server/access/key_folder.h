// The folder that makes a server trusted: its authority, its certificate, its tokens.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "access/certificates.h"
#include "access/tokens.h"
#include "base/result.h"

namespace helio::access {

/// Files of the folder: ca.crt, ca.key (signs the next server certificate), server.crt, server.key, tokens.json.
class KeyFolder {
 public:
  explicit KeyFolder(std::filesystem::path folder) : folder_(std::move(folder)) {}

  std::filesystem::path authorityCertificate() const { return folder_ / "ca.crt"; }
  std::filesystem::path authorityKey() const { return folder_ / "ca.key"; }
  std::filesystem::path certificate() const { return folder_ / "server.crt"; }
  std::filesystem::path key() const { return folder_ / "server.key"; }
  TokenFile tokens() const { return TokenFile(folder_ / "tokens.json"); }
  const std::filesystem::path& path() const { return folder_; }

  /// Makes authority and server certificate. Errors: there is an authority already (conflict), hosts (invalid), the
  /// system's (invalid).
  Result<void> create(const std::vector<std::string>& hosts) const;
  /// Another server certificate from the same authority: clients that trust it notice nothing. Errors: likewise.
  Result<void> renew(const std::vector<std::string>& hosts) const;
  /// Of the authority: what `helio login` compares. Errors: it is not there (not_found).
  Result<std::string> fingerprint() const;
  /// Everything a server needs is there and fits together. Errors: the first thing that does not, and how to mend it.
  Result<void> check() const;

 private:
  std::filesystem::path folder_;
};

}  // namespace helio::access
