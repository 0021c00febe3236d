// heliographd: configuration, then wiring; nothing else.
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <atomic>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <thread>

#include "service/server.h"
#include "service/synthetic_renderer.h"
#include "store/sqlite_edit_log.h"

namespace {

using namespace helio;

constexpr const char* kExamples = R"(Examples:
  heliographd --city 10000                       a city of 10,000 instances, world "city", on 127.0.0.1:7700
  heliographd --device cpu --listen 127.0.0.1:0 --port-file port.txt
                                                 on the software device, at a free port that port.txt names
  heliographd --log-dir ~/worlds                 every acknowledged edit is on disk, and there again after a restart
  heliographd --renderer synthetic               no device: black and white blocks, for measuring the service
  heliographd --gltf-root ~/models               clients may make worlds of the files in there
Every flag can be set in the environment too: HELIOGRAPH_LISTEN, HELIOGRAPH_CITY, ...
The first SIGTERM or SIGINT tells the viewers and ends in order, the second ends at once.)";

int fail(const std::string& message) {
  std::cerr << "heliographd: " << message << "\n";
  return EXIT_FAILURE;
}

/// Blocks until SIGTERM or SIGINT. The signals are blocked in every thread, so that only this waits for them.
void waitForSignal(const sigset_t& signals) {
  int signal = 0;
  sigwait(&signals, &signal);
}

Result<std::unique_ptr<store::EditLog>> openLog(const std::string& folder,
                                                const std::function<void(const Error&)>& on_fatal) {
  if (folder.empty()) {
    spdlog::warn("worlds live in memory only and end with this process; --log-dir FOLDER keeps them");
    return store::makeMemoryEditLog();
  }
  store::SqliteLogOptions options;
  options.folder = folder;
  options.on_fatal = on_fatal;
  auto log = store::openSqliteEditLog(std::move(options));
  if (log) spdlog::info("worlds are kept in {}", folder);
  return log;
}

}  // namespace

int main(int argc, char** argv) {
  service::ServerConfig config;
  config.version = HELIOGRAPH_VERSION;
  config.encoder_threads = std::max(1u, std::thread::hardware_concurrency() / 2);
  render::RendererOptions device;
  service::SyntheticOptions synthetic;
  uint64_t synthetic_frame_us = 0;
  std::string renderer_name = "vulkan";
  scene::CityParameters city{1, 0};
  std::string world = "city", log_folder, port_file, log_level = "info";

  CLI::App app("Hosts worlds, renders them, and streams pictures to viewers.", "heliographd");
  app.footer(kExamples);
  app.set_version_flag("--version", config.version);
  const auto flag = [&](const char* name, auto& value, const char* help) {
    std::string variable = std::string("HELIOGRAPH_") + (name + 2);
    for (char& c : variable) c = c == '-' ? '_' : static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    return app.add_option(name, value, help)->envname(variable)->capture_default_str();
  };
  flag("--listen", config.address, "host:port on loopback; port 0 picks a free one");
  flag("--port-file", port_file, "file that gets the bound host:port, when the server is ready");
  flag("--renderer", renderer_name,
       "vulkan, or synthetic: pictures of blocks that say what they show, without a device")
      ->check(CLI::IsMember({"vulkan", "synthetic"}));
  flag("--synthetic-frame-us", synthetic_frame_us, "microseconds that a tick of the synthetic renderer takes");
  flag("--synthetic-noise", synthetic.noise, "grey levels of noise in its pictures, 0 to 100")
      ->check(CLI::Range(0, 100));
  flag("--device", device.device, "part of a Vulkan device's name, cpu or gpu; empty: the best there is");
  app.add_flag("--validation", device.validation, "Vulkan's validation layer")->envname("HELIOGRAPH_VALIDATION");
  app.add_flag("--strict-numerics", device.strict_numerics,
               "end at the first sample that is not finite, or negative, with a line that says where it was")
      ->envname("HELIOGRAPH_STRICT_NUMERICS");
  flag("--log-dir", log_folder,
       "folder that keeps the worlds and their edits over a restart; empty: memory keeps them");
  flag("--gltf-root", config.gltf_root, "folder whose glTF files may become worlds")->check(CLI::ExistingDirectory);
  flag("--city", city.instances, "make a city of so many instances at the start, 1,000 to 1,000,000");
  flag("--seed", city.seed, "of that city");
  flag("--world-name", world, "of that city");
  flag("--log-level", log_level, "trace, debug, info, warn, error")
      ->check(CLI::IsMember({"trace", "debug", "info", "warn", "error"}));
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);
    return fail(std::string(error.what()) + "; see heliographd --help");
  }
  spdlog::set_level(spdlog::level::from_str(log_level));

  // Before any thread starts: all inherit it.
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGTERM);
  sigaddset(&signals, SIGINT);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);

  // Crash-only: a supervisor starts the process again, and the viewers attach again.
  config.on_fatal = [](const Error& error) {
    std::cerr << "heliographd: cannot go on: " << error.message << std::endl;
    std::_Exit(EXIT_FAILURE);
  };
  auto log = openLog(log_folder, config.on_fatal);
  if (!log) return fail(log.error().message);
  synthetic.frame_time = std::chrono::microseconds(synthetic_frame_us);
  auto renderer =
      renderer_name == "synthetic" ? service::makeSyntheticRenderer(synthetic) : render::makeRenderer(device);
  if (!renderer) return fail(renderer.error().message);
  auto server = service::Server::start(std::move(config), **renderer, **log);
  if (!server) return fail(server.error().message);
  if (city.instances != 0)
    if (auto created = (*server)->createCity(world, city); !created) return fail(created.error().message);
  const auto info = (*renderer)->device();
  std::cout << "heliographd: ready on " << (*server)->address() << ", device " << info.name << " (" << info.driver
            << ")" << std::endl;
  if (!port_file.empty()) {
    std::ofstream file(port_file);
    file << (*server)->address() << "\n";
    if (!file.flush()) return fail("cannot write --port-file " + port_file);
  }

  waitForSignal(signals);
  spdlog::info("draining; a second signal ends at once");
  std::thread([signals] {
    waitForSignal(signals);
    std::_Exit(EXIT_FAILURE);
  }).detach();
  (*server)->drain();
  server->reset();
  return EXIT_SUCCESS;
}
