// X.509 certificates by OpenSSL: an authority of the server's own, and what it signs. All in PEM.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/result.h"

namespace helio::access {

/// A certificate with its private key (P-256).
struct Identity {
  std::string certificate;
  std::string key;
};

/// A certificate authority that signs for ten years. Errors: OpenSSL's (internal).
Result<Identity> makeAuthority(const std::string& name);

/// A certificate for a TLS server under `hosts` (names and addresses, at least one), signed by the authority, for 825
/// days. The authority's certificate follows in `certificate`, so that a client can take it from the connection and
/// compare its fingerprint. Errors: a host that is neither name nor address (invalid), OpenSSL's (internal).
Result<Identity> makeServerCertificate(const Identity& authority, const std::vector<std::string>& hosts);

/// SHA-256 of the first certificate in `pem`, 64 hexadecimal digits. Errors: there is none (invalid).
Result<std::string> fingerprintOf(const std::string& pem);

/// The first certificate in `pem`.
struct CertificateFacts {
  int64_t not_before = 0, not_after = 0;  ///< seconds since 1970
  std::vector<std::string> hosts;         ///< names and addresses it is for
};
Result<CertificateFacts> inspectCertificate(const std::string& pem);

/// The key belongs to the certificate, and the authority has signed it; dates are not looked at. Errors: which of these
/// does not hold (invalid).
Result<void> checkIdentity(const Identity& server, const std::string& authority_certificate);

}  // namespace helio::access
