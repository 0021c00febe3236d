// `helio-bench controller`: what a viewer's goal comes to over a quick flight.
#pragma once

#include <string>

#include "bench/command.h"

namespace CLI {
class App;
}

namespace helio::bench {

/// Adds the subcommand, which becomes `chosen` when it is the one on the command line.
void addControllerCommand(CLI::App& app, const std::string& command_line, Action& chosen);

}  // namespace helio::bench
