// `helio-bench viewers`: several viewers on one acceleration structure, against one for each.
#pragma once

#include <string>

#include "bench/command.h"

namespace CLI {
class App;
}

namespace helio::bench {

/// Adds the subcommand, which becomes `chosen` when it is the one on the command line.
void addViewersCommand(CLI::App& app, const std::string& command_line, Action& chosen);

}  // namespace helio::bench
