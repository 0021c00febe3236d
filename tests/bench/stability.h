// `helio-bench stability`: numerically hard cases at growing difficulty.
#pragma once

#include "bench/command.h"

namespace CLI {
class App;
}

namespace helio::bench {

/// Adds the subcommand, which becomes `chosen` when it is the one on the command line.
void addStabilityCommand(CLI::App& app, const std::string& command_line, Action& chosen);

}  // namespace helio::bench
