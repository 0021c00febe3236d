// helio-bench: one subcommand a benchmark.
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <exception>
#include <iostream>

#include "bench/ablation.h"
#include "bench/accuracy.h"
#include "bench/command.h"
#include "bench/controller.h"
#include "bench/crash.h"
#include "bench/culling.h"
#include "bench/edit_storm.h"
#include "bench/fidelity.h"
#include "bench/fly.h"
#include "bench/frame.h"
#include "bench/jump.h"
#include "bench/report.h"
#include "bench/rest.h"
#include "bench/sampler.h"
#include "bench/stability.h"
#include "bench/stream.h"
#include "bench/thresholds.h"
#include "bench/viewers.h"

namespace {

constexpr int kFailed = 1, kWrongUsage = 2;

int fail(int status, const std::string& message) {
  std::cerr << "helio-bench: " << message << std::endl;
  return status;
}

}  // namespace

int main(int argc, char** argv) {
  using namespace helio;
  spdlog::set_default_logger(spdlog::stderr_color_mt("helio-bench"));  // standard output is the result's
  spdlog::set_level(spdlog::level::warn);

  CLI::App app("Measures the parts in this process, without a network. One benchmark a subcommand.", "helio-bench");
  app.footer("Exit status: 0 success, 1 the measurement failed, 2 wrong usage.");
  app.require_subcommand(1);
  bench::Action action;
  const std::string command_line = bench::shellCommand(argc, argv);
  bench::addFrameCommand(app, command_line, action);
  bench::addFidelityCommand(app, command_line, action);
  bench::addSamplerCommand(app, command_line, action);
  bench::addAccuracyCommand(app, command_line, action);
  bench::addControllerCommand(app, command_line, action);
  bench::addCullingCommand(app, command_line, action);
  bench::addThresholdsCommand(app, command_line, action);
  bench::addAblationCommand(app, command_line, action);
  bench::addFlyCommand(app, command_line, action);
  bench::addViewersCommand(app, command_line, action);
  bench::addJumpCommand(app, command_line, action);
  bench::addEditStormCommand(app, command_line, action);
  bench::addRestCommand(app, command_line, action);
  bench::addStabilityCommand(app, command_line, action);
  bench::addCrashCommand(app, command_line, action);
  bench::addStreamCommand(app, command_line, action);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help
    return fail(kWrongUsage, std::string(error.what()) + "; see helio-bench --help");
  }

  try {
    if (auto done = action(); !done) return fail(kFailed, done.error().message);
  } catch (const std::exception& error) { return fail(kFailed, error.what()); }
  return 0;
}
