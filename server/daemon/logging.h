// How heliographd logs: text for people, or one JSON object a line for machines.
#pragma once

#include <string>

namespace helio::daemon {

/// For the whole process. `level`: trace to error. `format`: text, or json: {"time", "level", "message"}. Messages have
/// ids of tokens, never a token.
void configureLogs(const std::string& level, const std::string& format);

}  // namespace helio::daemon
