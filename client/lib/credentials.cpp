#include "lib/credentials.h"

#include <grpcpp/grpcpp.h>
#include <openssl/bio.h>
#include <openssl/err.h>
#include <openssl/pem.h>
#include <openssl/ssl.h>

#include <cstdlib>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>

#include "access/certificates.h"
#include "access/private_file.h"

namespace helio::client {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kSchema = "heliograph.credentials/1";

fs::path defaultPath() {
  const auto variable = [](const char* name) {
    const char* value = std::getenv(name);
    return std::string(value ? value : "");
  };
  if (const auto file = variable("HELIOGRAPH_CREDENTIALS"); !file.empty()) return file;
  if (const auto folder = variable("XDG_CONFIG_HOME"); !folder.empty())
    return fs::path(folder) / "heliograph" / "credentials.json";
  return fs::path(variable("HOME")) / ".config" / "heliograph" / "credentials.json";
}

Result<Json> readStore(const fs::path& path) {
  const auto bytes = access::readFile(path);
  if (!bytes && bytes.error().kind == ErrorKind::not_found)
    return Json{{"schema", kSchema}, {"newest", ""}, {"servers", Json::object()}};
  if (!bytes) return bytes.error();
  if (access::openToOthers(path))
    return invalid("credentials", path.string(),
                   path.string() + " can be read by others than you; chmod 600 " + path.string());
  try {
    auto json = Json::parse(*bytes);
    if (json.at("schema") != kSchema || !json.at("newest").is_string()) throw std::runtime_error("another schema");
    for (const auto& [address, entry] : json.at("servers").items())
      if (!entry.at("authority").is_string() || !entry.at("token").is_string())
        throw std::runtime_error("a server without authority or token");
    return json;
  } catch (const std::exception& error) {
    return Error{ErrorKind::damaged,
                 path.string() + " is not a file of credentials (" + error.what() + "); remove it, and log in again",
                 "credentials",
                 path.string(),
                 {}};
  }
}

/// Adds the token to every call of a channel.
class BearerToken final : public grpc::MetadataCredentialsPlugin {
 public:
  explicit BearerToken(const std::string& token) : value_("Bearer " + token) {}
  grpc::Status GetMetadata(grpc::string_ref, grpc::string_ref, const grpc::AuthContext&,
                           std::multimap<grpc::string, grpc::string>* metadata) override {
    metadata->emplace("authorization", value_);
    return grpc::Status::OK;
  }
  bool IsBlocking() const override { return false; }

 private:
  const std::string value_;
};

template <auto free_it>
struct Free {
  template <typename T>
  void operator()(T* object) const {
    free_it(object);
  }
};

std::string pemOf(X509* certificate) {
  const std::unique_ptr<BIO, Free<BIO_free_all>> memory(BIO_new(BIO_s_mem()));
  PEM_write_bio_X509(memory.get(), certificate);
  char* data = nullptr;
  const long size = BIO_get_mem_data(memory.get(), &data);
  return {data, static_cast<size_t>(size)};
}

}  // namespace

CredentialStore::CredentialStore() : path_(defaultPath()) {}

Result<std::optional<Credentials>> CredentialStore::find(const std::string& address) const {
  const auto json = readStore(path_);
  if (!json) return json.error();
  const auto& servers = json->at("servers");
  const auto found = servers.find(address);
  if (found == servers.end()) return std::optional<Credentials>();
  return std::optional<Credentials>({found->at("authority").get<std::string>(), found->at("token").get<std::string>()});
}

Result<std::string> CredentialStore::newestServer() const {
  const auto json = readStore(path_);
  if (!json) return json.error();
  return json->at("newest").get<std::string>();
}

Result<void> CredentialStore::keep(const std::string& address, const Credentials& credentials) const {
  auto json = readStore(path_);
  if (!json) return json.error();
  json->at("newest") = address;
  json->at("servers")[address] = {{"authority", credentials.authority}, {"token", credentials.token}};
  return access::writePrivateFile(path_, json->dump(1) + "\n");
}

Result<void> CredentialStore::forget(const std::string& address) const {
  auto json = readStore(path_);
  if (!json) return json.error();
  if (json->at("servers").erase(address) == 0)
    return Error{ErrorKind::not_found, "there are no credentials for " + address, "server", address, {}};
  if (json->at("newest") == address) json->at("newest") = "";
  return access::writePrivateFile(path_, json->dump(1) + "\n");
}

std::shared_ptr<grpc::Channel> makeChannel(const std::string& address, const std::optional<Credentials>& credentials,
                                           const grpc::ChannelArguments& arguments) {
  if (!credentials) return grpc::CreateCustomChannel(address, grpc::InsecureChannelCredentials(), arguments);
  grpc::SslCredentialsOptions tls;
  tls.pem_root_certs = credentials->authority;
  return grpc::CreateCustomChannel(
      address,
      grpc::CompositeChannelCredentials(
          grpc::SslCredentials(tls),
          grpc::MetadataCredentialsFromPlugin(std::make_unique<BearerToken>(credentials->token))),
      arguments);
}

Result<std::string> fetchAuthority(const std::string& address, const std::string& fingerprint) {
  const std::unique_ptr<SSL_CTX, Free<SSL_CTX_free>> context(SSL_CTX_new(TLS_client_method()));
  // Nothing is believed of this connection but the one certificate whose fingerprint is known.
  SSL_CTX_set_verify(context.get(), SSL_VERIFY_NONE, nullptr);
  SSL_CTX_set_min_proto_version(context.get(), TLS1_2_VERSION);
  constexpr unsigned char kHttp2[] = {2, 'h', '2'};
  SSL_CTX_set_alpn_protos(context.get(), kHttp2, sizeof kHttp2);
  const std::unique_ptr<BIO, Free<BIO_free_all>> connection(BIO_new_ssl_connect(context.get()));
  BIO_set_conn_hostname(connection.get(), address.c_str());
  if (BIO_do_connect_retry(connection.get(), 10, 100) != 1 || BIO_do_handshake(connection.get()) != 1) {
    char why[256] = "no answer";
    if (const auto code = ERR_get_error(); code != 0) ERR_error_string_n(code, why, sizeof why);
    ERR_clear_error();
    return Error{ErrorKind::unavailable,
                 "no server with TLS answers at " + address + " (" + why +
                     "); is heliographd running with --keys, and is this its address?",
                 "server",
                 address,
                 {}};
  }
  SSL* ssl = nullptr;
  BIO_get_ssl(connection.get(), &ssl);
  const auto* chain = SSL_get_peer_cert_chain(ssl);
  for (int i = 0; chain && i < sk_X509_num(chain); ++i) {
    std::string pem = pemOf(sk_X509_value(chain, i));
    if (const auto found = access::fingerprintOf(pem); found && *found == fingerprint) return pem;
  }
  return invalid("ca-sha256", fingerprint,
                 "the server at " + address +
                     " shows no authority with this fingerprint: it is another server than the one that printed the "
                     "login line, or somebody stands between");
}

}  // namespace helio::client
