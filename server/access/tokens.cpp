#include "access/tokens.h"

#include <openssl/crypto.h>
#include <openssl/evp.h>
#include <openssl/rand.h>
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "access/private_file.h"

namespace helio::access {
namespace {

using Digest = std::array<uint8_t, 32>;

constexpr const char* kSchema = "heliograph.tokens/1";
constexpr std::string_view kPrefix = "helio_";
constexpr size_t kIdLength = 12, kSecretLength = 64;  // hexadecimal digits
constexpr int64_t kMostSeconds = int64_t{100} * 366 * 86'400;

std::string hex(const uint8_t* bytes, size_t count) {
  std::string out;
  for (size_t i = 0; i < count; ++i) out += fmt::format("{:02x}", bytes[i]);
  return out;
}

bool isHex(std::string_view text) {
  return std::all_of(text.begin(), text.end(), [](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); });
}

std::string randomHex(size_t digits) {
  std::vector<uint8_t> bytes(digits / 2);
  if (RAND_bytes(bytes.data(), static_cast<int>(bytes.size())) != 1)
    throw std::runtime_error("the system has no random numbers for a token");
  return hex(bytes.data(), bytes.size());
}

Digest digestOf(std::string_view secret) {
  Digest digest{};
  if (EVP_Digest(secret.data(), secret.size(), digest.data(), nullptr, EVP_sha256(), nullptr) != 1)
    throw std::runtime_error("OpenSSL has no SHA-256");
  return digest;
}

Digest parseDigest(const std::string& text) {
  if (text.size() != 64 || !isHex(text)) throw std::runtime_error("sha256 is not 64 hexadecimal digits");
  Digest digest{};
  for (size_t i = 0; i < digest.size(); ++i)
    digest[i] = static_cast<uint8_t>(std::stoul(text.substr(2 * i, 2), nullptr, 16));
  return digest;
}

nlohmann::ordered_json toJson(const Token& token) {
  return {{"id", token.id},
          {"name", token.name},
          {"scope", nameOf(token.scope)},
          {"worlds", token.worlds},
          {"created", token.created},
          {"expires", token.expires},
          {"sha256", hex(token.digest.data(), token.digest.size())}};
}

/// Throws what is wrong.
Token fromJson(const nlohmann::json& json) {
  Token token;
  token.id = json.at("id").get<std::string>();
  if (token.id.size() != kIdLength || !isHex(token.id)) throw std::runtime_error("an id is not 12 hexadecimal digits");
  token.name = json.at("name").get<std::string>();
  const auto scope = parseScope(json.at("scope").get<std::string>());
  if (!scope) throw std::runtime_error("a scope is not view, edit or admin");
  token.scope = *scope;
  token.worlds = json.at("worlds").get<std::set<std::string>>();
  token.created = json.at("created").get<int64_t>();
  token.expires = json.at("expires").get<int64_t>();
  token.digest = parseDigest(json.at("sha256").get<std::string>());
  return token;
}

Result<void> check(const TokenFile::Wish& wish) {
  const auto printable = [](char c) { return c >= ' ' && c <= '~'; };
  if (wish.name.empty() || wish.name.size() > 64 || !std::all_of(wish.name.begin(), wish.name.end(), printable))
    return invalid("name", wish.name.substr(0, 80), "a token's name is 1 to 64 printable characters of ASCII");
  if (wish.scope == Scope::none) return invalid("scope", "none", "a token's scope is view, edit or admin");
  if (wish.lifetime < 0 || wish.lifetime > kMostSeconds)
    return invalid("lifetime", std::to_string(wish.lifetime),
                   "a token's lifetime is 0 (for good) to 100 years, in seconds");
  return {};
}

}  // namespace

const char* nameOf(Scope scope) {
  switch (scope) {
    case Scope::view:
      return "view";
    case Scope::edit:
      return "edit";
    case Scope::admin:
      return "admin";
    case Scope::none:
      break;
  }
  return "none";
}

std::optional<Scope> parseScope(std::string_view name) {
  for (const Scope scope : {Scope::view, Scope::edit, Scope::admin})
    if (name == nameOf(scope)) return scope;
  return std::nullopt;
}

int64_t unixTime() {
  return std::chrono::duration_cast<std::chrono::seconds>(std::chrono::system_clock::now().time_since_epoch()).count();
}

const Token* find(const std::vector<Token>& tokens, std::string_view text) {
  if (text.size() != kPrefix.size() + kIdLength + 1 + kSecretLength || text.substr(0, kPrefix.size()) != kPrefix)
    return nullptr;
  const std::string_view id = text.substr(kPrefix.size(), kIdLength);
  const Digest digest = digestOf(text.substr(text.size() - kSecretLength));
  for (const Token& token : tokens)
    if (token.id == id && CRYPTO_memcmp(token.digest.data(), digest.data(), digest.size()) == 0) return &token;
  return nullptr;
}

Result<std::vector<Token>> TokenFile::read() const {
  const auto bytes = readFile(path_);
  if (!bytes) return bytes.error();
  try {
    const auto json = nlohmann::json::parse(*bytes);
    if (json.at("schema") != kSchema) throw std::runtime_error("its schema is not " + std::string(kSchema));
    std::vector<Token> tokens;
    for (const auto& entry : json.at("tokens")) tokens.push_back(fromJson(entry));
    return tokens;
  } catch (const std::exception& error) {
    return Error{ErrorKind::damaged,
                 fmt::format("{} is not a file of tokens: {}", path_.string(), error.what()),
                 "file",
                 path_.string(),
                 {}};
  }
}

Result<void> TokenFile::write(const std::vector<Token>& tokens) const {
  nlohmann::ordered_json json = {{"schema", kSchema}, {"tokens", nlohmann::ordered_json::array()}};
  for (const Token& token : tokens) json["tokens"].push_back(toJson(token));
  return writePrivateFile(path_, json.dump(1) + "\n");
}

Result<TokenFile::Created> TokenFile::create(const Wish& wish) const {
  if (auto good = check(wish); !good) return good.error();
  const FolderLock lock(path_.parent_path());
  std::vector<Token> tokens;
  if (auto there = read(); there) tokens = std::move(*there);
  else if (there.error().kind != ErrorKind::not_found) return there.error();
  if (tokens.size() >= kMostTokens)
    return Error{ErrorKind::limit, fmt::format("there are {} tokens already; revoke one", kMostTokens), "tokens",
                 std::to_string(tokens.size()), std::to_string(kMostTokens)};
  const int64_t now = unixTime();
  const std::string secret = randomHex(kSecretLength);
  Token token{randomHex(kIdLength), wish.name, wish.scope, wish.worlds, now, wish.lifetime ? now + wish.lifetime : 0,
              digestOf(secret)};
  tokens.push_back(token);
  if (auto written = write(tokens); !written) return written.error();
  return Created{token, fmt::format("{}{}_{}", kPrefix, token.id, secret)};
}

Result<void> TokenFile::revoke(const std::string& id) const {
  const FolderLock lock(path_.parent_path());
  auto tokens = read();
  if (!tokens) return tokens.error();
  if (std::erase_if(*tokens, [&](const Token& token) { return token.id == id; }) == 0)
    return Error{ErrorKind::not_found,
                 "there is no token \"" + id.substr(0, 80) + "\"; list the tokens to see their ids",
                 "id",
                 id.substr(0, 80),
                 {}};
  return write(*tokens);
}

}  // namespace helio::access
