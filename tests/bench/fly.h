// `helio-bench fly`: ten seconds of quick flight, tick by tick: what keeping up costs.
#pragma once

#include <string>

#include "bench/command.h"

namespace CLI {
class App;
}

namespace helio::bench {

/// Adds the subcommand, which becomes `chosen` when it is the one on the command line.
void addFlyCommand(CLI::App& app, const std::string& command_line, Action& chosen);

}  // namespace helio::bench
