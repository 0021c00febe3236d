// `helio-bench stream`: what the service adds to the codec and the transport that it cannot do without.
#pragma once

#include <string>

#include "bench/command.h"

namespace CLI {
class App;
}

namespace helio::bench {

/// Adds the subcommand, which becomes `chosen` when it is the one on the command line.
void addStreamCommand(CLI::App& app, const std::string& command_line, Action& chosen);

}  // namespace helio::bench
