// heliographd init: what a server needs to be trusted.
#pragma once

#include <string>

#include "base/result.h"
#include "daemon/configuration.h"

namespace helio::daemon {

/// Makes the keys in configuration.server.keys, or renews the certificate, or makes another admin token. Returns the
/// line that a client pastes; empty when only the certificate was renewed. Errors: access::KeyFolder's.
Result<std::string> initialise(const Configuration& configuration, const InitOptions& options);

}  // namespace helio::daemon
