// `helio-bench sampler`: error against samples, of the low-discrepancy sampler and of independent samples.
#pragma once

#include "bench/command.h"

namespace CLI {
class App;
}

namespace helio::bench {

/// Adds the subcommand, which becomes `chosen` when it is the one on the command line.
void addSamplerCommand(CLI::App& app, const std::string& command_line, Action& chosen);

}  // namespace helio::bench
