#include "bench/device.h"

#include <CLI/CLI.hpp>

namespace helio::bench {

void addDeviceOptions(CLI::App& command, render::RendererOptions& options) {
  command
      .add_option("--device", options.device, "part of a Vulkan device's name, cpu or gpu; default: the best there is")
      ->envname("HELIOGRAPH_DEVICE");
  command
      .add_flag("--strict-numerics", options.strict_numerics,
                "stop at the first sample that is not finite, or negative, and say where it was")
      ->envname("HELIOGRAPH_STRICT_NUMERICS");
}

}  // namespace helio::bench
