// What heliographd is told: by flags, by the environment, by a file; in this order, the first that speaks counts.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "render/renderer.h"
#include "scene/city.h"
#include "service/server.h"
#include "service/synthetic_renderer.h"

namespace helio::daemon {

struct Configuration {
  service::ServerConfig server;
  std::string ops_address;  ///< host:port of health and metrics; empty: none
  std::string renderer = "vulkan";
  render::RendererOptions device;
  service::SyntheticOptions synthetic;
  scene::CityParameters city{1, 0, 0};  ///< 0 instances: none
  std::string city_name = "city";
  std::string log_folder;  ///< empty: worlds live in memory
  std::string port_file;
  std::string log_level = "info", log_format = "text";
  std::string in_effect;  ///< all of it, as a configuration file
};

enum class Command { serve, check_configuration, init, doctor };

struct InitOptions {
  std::vector<std::string> hosts;  ///< beside localhost and this machine's name
  bool renew = false, new_token = false;
};

struct Invocation {
  Command command = Command::serve;
  Configuration configuration;
  InitOptions init;
  bool json = false;  ///< of doctor
};

/// Every flag --some-name is the environment variable HELIOGRAPH_SOME_NAME and the key some-name of the YAML file of
/// --config too. None: help or version was asked for, and printed. Errors: what is unknown or out of range (invalid).
Result<std::optional<Invocation>> parseCommandLine(int argc, const char* const* argv);

}  // namespace helio::daemon
