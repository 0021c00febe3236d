// `helio-bench thresholds`: what the thresholds of light path guided culling cost and save, as a sweep.
#pragma once

#include <string>

#include "bench/command.h"

namespace CLI {
class App;
}

namespace helio::bench {

/// Adds the subcommand, which becomes `chosen` when it is the one on the command line.
void addThresholdsCommand(CLI::App& app, const std::string& command_line, Action& chosen);

}  // namespace helio::bench
