// `helio-bench ablation`: rasterised primary hits, light path guided culling and the shadow map of what it culls, each
// alone and together.
#pragma once

#include <string>

#include "bench/command.h"

namespace CLI {
class App;
}

namespace helio::bench {

/// Adds the subcommand, which becomes `chosen` when it is the one on the command line.
void addAblationCommand(CLI::App& app, const std::string& command_line, Action& chosen);

}  // namespace helio::bench
