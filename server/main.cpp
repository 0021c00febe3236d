// heliographd: what was asked for, then wiring; nothing else.
#include <spdlog/spdlog.h>

#include <csignal>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <thread>

#include "daemon/configuration.h"
#include "daemon/doctor.h"
#include "daemon/init.h"
#include "daemon/logging.h"
#include "daemon/ops_port.h"
#include "service/server.h"
#include "service/synthetic_renderer.h"
#include "store/sqlite_edit_log.h"

namespace {

using namespace helio;

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

Result<std::unique_ptr<render::Renderer>> makeRenderer(const daemon::Configuration& configuration) {
  if (configuration.renderer == "synthetic") return service::makeSyntheticRenderer(configuration.synthetic);
  return render::makeRenderer(configuration.device);
}

int serve(daemon::Configuration configuration) {
  daemon::configureLogs(configuration.log_level, configuration.log_format);
  // Before any thread starts: all inherit it.
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGTERM);
  sigaddset(&signals, SIGINT);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);

  // Crash-only: a supervisor starts the process again, and the viewers attach again.
  configuration.server.on_fatal = [](const Error& error) {
    std::cerr << "heliographd: cannot go on: " << error.message << std::endl;
    std::_Exit(EXIT_FAILURE);
  };
  // First of all, and until the end: a slow start or a slow drain is no reason to restart.
  std::unique_ptr<daemon::OpsPort> ops;
  if (!configuration.ops_address.empty()) {
    auto opened = daemon::OpsPort::open(configuration.ops_address);
    if (!opened) return fail(opened.error().message);
    ops = std::move(*opened);
    spdlog::info("health and metrics on {}", ops->address());
  }
  auto log = openLog(configuration.log_folder, configuration.server.on_fatal);
  if (!log) return fail(log.error().message);
  auto renderer = makeRenderer(configuration);
  if (!renderer) return fail(renderer.error().message);
  auto server = service::Server::start(configuration.server, **renderer, **log);
  if (!server) return fail(server.error().message);
  if (configuration.city.instances != 0)
    if (auto created = (*server)->createCity(configuration.city_name, configuration.city); !created)
      return fail(created.error().message);
  const auto info = (*renderer)->device();
  const auto ready = fmt::format("ready on {}, device {} ({})", (*server)->address(), info.name, info.driver);
  if (configuration.log_format == "json") spdlog::info("{}", ready);
  else std::cout << "heliographd: " << ready << std::endl;
  if (!configuration.port_file.empty()) {
    std::ofstream file(configuration.port_file);
    file << (*server)->address() << "\n";
    if (!file.flush()) return fail("cannot write --port-file " + configuration.port_file);
  }

  if (ops) ops->show({[&] { return (*server)->notReady(); }, [&] { return (*server)->metrics(); }});

  waitForSignal(signals);
  spdlog::info("draining; a second signal ends at once");
  std::thread([signals] {
    waitForSignal(signals);
    std::_Exit(EXIT_FAILURE);
  }).detach();
  (*server)->drain();
  if (ops) ops->show({});
  server->reset();
  return EXIT_SUCCESS;
}

int initialise(const daemon::Invocation& invocation) {
  const auto line = daemon::initialise(invocation.configuration, invocation.init);
  if (!line) return fail(line.error().message);
  const auto folder = invocation.configuration.server.keys.string();
  if (invocation.init.renew) std::cerr << "heliographd: renewed the certificate in " << folder << "\n";
  if (line->empty()) return EXIT_SUCCESS;
  // Standard output has the line alone, for scripts.
  std::cerr << "heliographd: the keys are in " << folder << "; serve with --keys " << folder
            << ", and give who shall administer it this line, which is shown this once:\n";
  std::cout << *line << std::endl;
  return EXIT_SUCCESS;
}

}  // namespace

int main(int argc, char** argv) {
  auto invocation = daemon::parseCommandLine(argc, argv);
  if (!invocation) return fail(invocation.error().message);
  if (!*invocation) return EXIT_SUCCESS;
  switch ((*invocation)->command) {
    case daemon::Command::check_configuration:
      std::cout << (*invocation)->configuration.in_effect;
      return EXIT_SUCCESS;
    case daemon::Command::init:
      return initialise(**invocation);
    case daemon::Command::doctor: {
      const auto findings = daemon::examine((*invocation)->configuration);
      std::cout << daemon::report(findings, (*invocation)->json);
      return daemon::canServe(findings) ? EXIT_SUCCESS : EXIT_FAILURE;
    }
    case daemon::Command::serve:
      break;
  }
  return serve(std::move((*invocation)->configuration));
}
