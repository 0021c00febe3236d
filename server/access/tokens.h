// Tokens: who may do what. The file of a server's tokens holds digests, never a token.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/result.h"

namespace helio::access {

/// Each includes the ones before it.
enum class Scope { none, view, edit, admin };
const char* nameOf(Scope scope);
std::optional<Scope> parseScope(std::string_view name);

struct Token {
  std::string id;    ///< 12 hexadecimal digits, no secret
  std::string name;  ///< for people
  Scope scope = Scope::none;
  std::set<std::string> worlds;    ///< empty: every world
  int64_t created = 0;             ///< seconds since 1970
  int64_t expires = 0;             ///< likewise; 0: never
  std::array<uint8_t, 32> digest;  ///< SHA-256 of the secret

  bool expired(int64_t now) const { return expires != 0 && now >= expires; }
};

/// The token that `text`, "helio_ID_SECRET", is; none: unknown. It compares digests in constant time. A secret is 32
/// random bytes, so that one SHA-256 is as good as a slow password hash: there is nothing to guess.
const Token* find(const std::vector<Token>& tokens, std::string_view text);

/// Seconds since 1970, now.
int64_t unixTime();

/// A server's tokens as a JSON file. Every change holds the lock of its folder and replaces the file in one step, so
/// that a running server and `heliographd init` may both write.
class TokenFile {
 public:
  static constexpr size_t kMostTokens = 1000;  ///< all of them are looked at by every call

  explicit TokenFile(std::filesystem::path path) : path_(std::move(path)) {}

  const std::filesystem::path& path() const { return path_; }
  /// Errors: not there (not_found), not a token file (damaged).
  Result<std::vector<Token>> read() const;

  struct Wish {
    std::string name;  ///< 1 to 64 printable characters
    Scope scope = Scope::none;
    std::set<std::string> worlds;
    int64_t lifetime = 0;  ///< seconds; 0: for good
  };
  struct Created {
    Token token;
    std::string text;  ///< what the client sends
  };
  /// Errors: name, scope or lifetime (invalid), kMostTokens (limit), those of read() but not_found.
  Result<Created> create(const Wish& wish) const;
  /// Errors: unknown id (not_found), those of read().
  Result<void> revoke(const std::string& id) const;

 private:
  Result<void> write(const std::vector<Token>& tokens) const;

  std::filesystem::path path_;
};

}  // namespace helio::access
