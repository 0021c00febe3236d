// What a client needs to be let in: the authority to trust, and its token. Kept in one private file.
#pragma once

#include <grpcpp/channel.h>
#include <grpcpp/support/channel_arguments.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "base/result.h"

namespace helio::client {

struct Credentials {
  std::string authority;  ///< certificate in PEM: the one that signed the server's
  std::string token;
};

/// The file of credentials by server address, mode 0600.
class CredentialStore {
 public:
  /// $HELIOGRAPH_CREDENTIALS, or heliograph/credentials.json in $XDG_CONFIG_HOME or ~/.config.
  CredentialStore();
  explicit CredentialStore(std::filesystem::path path) : path_(std::move(path)) {}

  const std::filesystem::path& path() const { return path_; }
  /// None: there are none for this address. Errors: the file is not what this class writes (damaged), others can read
  /// it (invalid).
  Result<std::optional<Credentials>> find(const std::string& address) const;
  /// The server that was logged in to last; empty: none.
  Result<std::string> newestServer() const;
  /// Errors: those of find(), the system's.
  Result<void> keep(const std::string& address, const Credentials& credentials) const;
  /// Errors: there are none (not_found), those of keep().
  Result<void> forget(const std::string& address) const;

 private:
  std::filesystem::path path_;
};

/// With credentials over TLS, and the token in every call; without them in plain text.
std::shared_ptr<grpc::Channel> makeChannel(const std::string& address, const std::optional<Credentials>& credentials,
                                           const grpc::ChannelArguments& arguments);

/// Connects, and takes the certificate with this SHA-256 `fingerprint` (64 hexadecimal digits) from those that the
/// server shows. Errors: nobody answers, or not with TLS (unavailable); none of them has it (invalid).
Result<std::string> fetchAuthority(const std::string& address, const std::string& fingerprint);

}  // namespace helio::client
