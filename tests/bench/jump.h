// `helio-bench jump`: what a camera jump costs, from an empty view into the city, with and without latency mitigation.
#pragma once

#include <string>

#include "bench/command.h"

namespace CLI {
class App;
}

namespace helio::bench {

/// Adds the subcommand, which becomes `chosen` when it is the one on the command line.
void addJumpCommand(CLI::App& app, const std::string& command_line, Action& chosen);

}  // namespace helio::bench
