#include "access/certificates.h"

#include <arpa/inet.h>
#include <openssl/bio.h>
#include <openssl/ec.h>
#include <openssl/err.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/rand.h>
#include <openssl/x509.h>
#include <openssl/x509v3.h>
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cctype>
#include <memory>
#include <utility>

namespace helio::access {
namespace {

constexpr long kDay = 86'400, kAuthorityDays = 3653, kServerDays = 825;

template <auto free_it>
struct Free {
  template <typename T>
  void operator()(T* object) const {
    free_it(object);
  }
};
using Bio = std::unique_ptr<BIO, Free<BIO_free_all>>;
using Key = std::unique_ptr<EVP_PKEY, Free<EVP_PKEY_free>>;
using Certificate = std::unique_ptr<X509, Free<X509_free>>;
using Extension = std::unique_ptr<X509_EXTENSION, Free<X509_EXTENSION_free>>;
using Names = std::unique_ptr<GENERAL_NAMES, Free<GENERAL_NAMES_free>>;

Error opensslError(const std::string& what) {
  char text[256] = "no reason given";
  if (const auto code = ERR_get_error(); code != 0) ERR_error_string_n(code, text, sizeof text);
  ERR_clear_error();
  return {ErrorKind::internal, what + ": " + text, {}, {}, {}};
}

std::string textOf(BIO* memory) {
  char* data = nullptr;
  const long size = BIO_get_mem_data(memory, &data);
  return {data, static_cast<size_t>(size)};
}

std::string pemOf(X509* certificate) {
  const Bio memory(BIO_new(BIO_s_mem()));
  PEM_write_bio_X509(memory.get(), certificate);
  return textOf(memory.get());
}

std::string pemOf(EVP_PKEY* key) {
  const Bio memory(BIO_new(BIO_s_mem()));
  PEM_write_bio_PrivateKey(memory.get(), key, nullptr, nullptr, 0, nullptr, nullptr);
  return textOf(memory.get());
}

Certificate parseCertificate(const std::string& pem) {
  const Bio memory(BIO_new_mem_buf(pem.data(), static_cast<int>(pem.size())));
  return Certificate(PEM_read_bio_X509(memory.get(), nullptr, nullptr, nullptr));
}

Key parseKey(const std::string& pem) {
  const Bio memory(BIO_new_mem_buf(pem.data(), static_cast<int>(pem.size())));
  return Key(PEM_read_bio_PrivateKey(memory.get(), nullptr, nullptr, nullptr));
}

/// RFC 5280: positive, at most 20 octets, and nobody else's.
bool setRandomSerial(X509* certificate) {
  uint8_t bytes[16];
  if (RAND_bytes(bytes, sizeof bytes) != 1) return false;
  bytes[0] &= 0x7f;
  std::unique_ptr<BIGNUM, Free<BN_free>> number(BN_bin2bn(bytes, sizeof bytes, nullptr));
  return BN_to_ASN1_INTEGER(number.get(), X509_get_serialNumber(certificate)) != nullptr;
}

bool addExtension(X509* certificate, X509* issuer, int kind, const std::string& value) {
  X509V3_CTX context;
  X509V3_set_ctx_nodb(&context);
  X509V3_set_ctx(&context, issuer, certificate, nullptr, nullptr, 0);
  const Extension extension(X509V3_EXT_conf_nid(nullptr, &context, kind, value.c_str()));
  return extension && X509_add_ext(certificate, extension.get(), -1) == 1;
}

using Extensions = std::vector<std::pair<int, std::string>>;

/// A certificate of `key` for `name`; `issuer` none: it signs itself.
Result<Identity> makeCertificate(const std::string& name, long days, const Extensions& extensions, X509* issuer,
                                 EVP_PKEY* issuer_key) {
  const Key key(EVP_EC_gen("P-256"));
  const Certificate certificate(X509_new());
  if (!key || !certificate) return opensslError("cannot make a key");
  X509_set_version(certificate.get(), X509_VERSION_3);
  X509_gmtime_adj(X509_getm_notBefore(certificate.get()), -kDay);  // clocks differ
  X509_gmtime_adj(X509_getm_notAfter(certificate.get()), days * kDay);
  X509_set_pubkey(certificate.get(), key.get());
  auto* subject = X509_get_subject_name(certificate.get());
  bool good = setRandomSerial(certificate.get()) &&
              X509_NAME_add_entry_by_txt(subject, "CN", MBSTRING_UTF8,
                                         reinterpret_cast<const unsigned char*>(name.c_str()), -1, -1, 0) == 1 &&
              X509_set_issuer_name(certificate.get(), issuer ? X509_get_subject_name(issuer) : subject) == 1;
  for (const auto& [kind, value] : extensions)
    good = good && addExtension(certificate.get(), issuer ? issuer : certificate.get(), kind, value);
  good = good && X509_sign(certificate.get(), issuer_key ? issuer_key : key.get(), EVP_sha256()) != 0;
  if (!good) return opensslError("cannot make a certificate for " + name);
  return Identity{pemOf(certificate.get()), pemOf(key.get())};
}

bool isAddress(const std::string& host) {
  uint8_t bytes[16];
  return inet_pton(AF_INET, host.c_str(), bytes) == 1 || inet_pton(AF_INET6, host.c_str(), bytes) == 1;
}

bool isName(const std::string& host) {
  return !host.empty() && host.size() <= 253 && std::all_of(host.begin(), host.end(), [](unsigned char c) {
    return std::isalnum(c) || c == '-' || c == '.' || c == '*' || c == '_';
  });
}

int64_t secondsOf(const ASN1_TIME* time) {
  tm broken{};
  ASN1_TIME_to_tm(time, &broken);
  return timegm(&broken);
}

std::string hostOf(const GENERAL_NAME* name) {
  int kind = 0;
  const auto* value = static_cast<const ASN1_STRING*>(GENERAL_NAME_get0_value(name, &kind));
  const auto* bytes = ASN1_STRING_get0_data(value);
  const auto size = static_cast<size_t>(ASN1_STRING_length(value));
  if (kind == GEN_DNS) return {reinterpret_cast<const char*>(bytes), size};
  char text[INET6_ADDRSTRLEN] = "";
  if (kind == GEN_IPADD) inet_ntop(size == 4 ? AF_INET : AF_INET6, bytes, text, sizeof text);
  return text;
}

}  // namespace

Result<Identity> makeAuthority(const std::string& name) {
  return makeCertificate(name, kAuthorityDays,
                         {{NID_basic_constraints, "critical,CA:TRUE,pathlen:0"},
                          {NID_key_usage, "critical,keyCertSign,cRLSign"},
                          {NID_subject_key_identifier, "hash"}},
                         nullptr, nullptr);
}

Result<Identity> makeServerCertificate(const Identity& authority, const std::vector<std::string>& hosts) {
  if (hosts.empty()) return invalid("host", "none", "a server's certificate needs at least one host");
  std::string alternatives;
  for (const auto& host : hosts) {
    const bool address = isAddress(host);
    if (!address && !isName(host))
      return invalid("host", host, "host \"" + host + "\" is neither a name nor an address; give it without a port");
    alternatives += (alternatives.empty() ? "" : ",") + std::string(address ? "IP:" : "DNS:") + host;
  }
  const auto issuer = parseCertificate(authority.certificate);
  const auto issuer_key = parseKey(authority.key);
  if (!issuer || !issuer_key) return opensslError("the authority's certificate or key cannot be read");
  auto made = makeCertificate("heliographd", kServerDays,
                              {{NID_basic_constraints, "critical,CA:FALSE"},
                               {NID_key_usage, "critical,digitalSignature"},
                               {NID_ext_key_usage, "serverAuth"},
                               {NID_authority_key_identifier, "keyid"},
                               {NID_subject_alt_name, alternatives}},
                              issuer.get(), issuer_key.get());
  if (made) made->certificate += authority.certificate;
  return made;
}

Result<std::string> fingerprintOf(const std::string& pem) {
  const auto certificate = parseCertificate(pem);
  uint8_t digest[EVP_MAX_MD_SIZE];
  unsigned size = 0;
  if (!certificate || X509_digest(certificate.get(), EVP_sha256(), digest, &size) != 1) {
    ERR_clear_error();
    return invalid("certificate", "", "this is not a certificate in PEM form");
  }
  std::string text;
  for (unsigned i = 0; i < size; ++i) text += fmt::format("{:02x}", digest[i]);
  return text;
}

Result<CertificateFacts> inspectCertificate(const std::string& pem) {
  const auto certificate = parseCertificate(pem);
  if (!certificate) {
    ERR_clear_error();
    return invalid("certificate", "", "this is not a certificate in PEM form");
  }
  CertificateFacts facts{
      secondsOf(X509_get0_notBefore(certificate.get())), secondsOf(X509_get0_notAfter(certificate.get())), {}};
  const Names names(
      static_cast<GENERAL_NAMES*>(X509_get_ext_d2i(certificate.get(), NID_subject_alt_name, nullptr, nullptr)));
  for (int i = 0; names && i < sk_GENERAL_NAME_num(names.get()); ++i)
    facts.hosts.push_back(hostOf(sk_GENERAL_NAME_value(names.get(), i)));
  return facts;
}

Result<void> checkIdentity(const Identity& server, const std::string& authority_certificate) {
  const auto certificate = parseCertificate(server.certificate), authority = parseCertificate(authority_certificate);
  const auto key = parseKey(server.key);
  ERR_clear_error();
  if (!certificate || !key || !authority)
    return invalid("certificate", "", "the server's certificate, its key or the authority's is not in PEM form");
  if (X509_check_private_key(certificate.get(), key.get()) != 1) {
    ERR_clear_error();
    return invalid("key", "", "the server's key does not belong to its certificate");
  }
  if (X509_verify(certificate.get(), X509_get0_pubkey(authority.get())) != 1) {
    ERR_clear_error();
    return invalid("certificate", "", "the server's certificate is not signed by the authority beside it");
  }
  return {};
}

}  // namespace helio::access
