// `helio-bench rest`: whether light path guided culling comes to rest where nothing moves.
#pragma once

#include <string>

#include "bench/command.h"

namespace CLI {
class App;
}

namespace helio::bench {

/// Adds the subcommand, which becomes `chosen` when it is the one on the command line.
void addRestCommand(CLI::App& app, const std::string& command_line, Action& chosen);

}  // namespace helio::bench
