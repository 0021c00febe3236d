// What main() and the subcommands agree on.
#pragma once

#include <functional>

#include "base/result.h"

namespace helio::bench {

/// Does what the command line asks for, once it was read. Prints the result, and nothing else, on standard output.
using Action = std::function<Result<void>()>;

}  // namespace helio::bench
