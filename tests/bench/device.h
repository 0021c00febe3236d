// Which device a benchmark runs on, and how strict it is there.
#pragma once

#include "render/renderer.h"

namespace CLI {
class App;
}

namespace helio::bench {

/// --device and --strict-numerics, which refer to `options` from then on.
void addDeviceOptions(CLI::App& command, render::RendererOptions& options);

}  // namespace helio::bench
