#include "bench/crash.h"

#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>

#include "bench/progress.h"
#include "bench/report.h"
#include "crash/crash_test_run.h"

namespace helio::bench {
namespace {

constexpr const char* kNotes = R"(What a cycle is:
  Four writers edit two worlds, whose snapshots are written meanwhile, until the power goes at a random moment. The disk,
  which is in memory, then forgets of what was not synced all, nothing, or any sectors. The log is opened again and
  compared with what the writers were told; requests that got no answer are repeated.
  lost: edits that were acknowledged and are not there. doubled: edits that are there twice.
Exit status 1 when edits were lost or doubled, unless --synchronous off asks for it.

Examples:
  helio-bench crash --cycles 200
  helio-bench crash --cycles 20 --synchronous off --json)";

struct CrashOptions {
  crash::Options run;
  std::string synchronous = "full";
  bool json = false;
};

void print(const CrashOptions& options, const crash::Report& report, const std::string& command) {
  if (options.json) {
    const Json json = {{"schema", "heliograph.bench.crash/1"},
                       {"command", command},
                       {"synchronous", options.synchronous},
                       {"seed", options.run.seed},
                       {"cycles", report.cycles},
                       {"acknowledged", report.acknowledged},
                       {"lost", report.lost},
                       {"doubled", report.doubled},
                       {"settled", report.settled},
                       {"snapshots", report.snapshots},
                       {"unreadable", report.unreadable}};
    std::cout << json.dump(2) << std::endl;
    return;
  }
  Table table({"cycles", "acknowledged", "lost", "doubled", "settled by a repeat", "snapshots", "logs beyond reading"});
  table.add({grouped(report.cycles), grouped(report.acknowledged), grouped(report.lost), grouped(report.doubled),
             grouped(report.settled), grouped(report.snapshots), grouped(report.unreadable)});
  std::cout << table.markdown();
}

Result<void> measureCrashes(CrashOptions options, const std::string& command) {
  options.run.synchronous = options.synchronous == "full";
  Progress progress("crashing", options.run.cycles);
  options.run.on_cycle = [&progress] { progress.step(); };
  const auto report = crash::run(options.run);
  if (!report) return report.error();
  print(options, *report, command);
  if (options.run.synchronous && report->lost + report->doubled > 0)
    return Error{ErrorKind::internal, "acknowledged edits were lost or doubled", {}, {}, {}};
  return {};
}

}  // namespace

void addCrashCommand(CLI::App& app, const std::string& command_line, Action& chosen) {
  const auto options = std::make_shared<CrashOptions>();
  CLI::App& command =
      *app.add_subcommand("crash", "lets the power go while edits are written, and counts what is lost");
  command.footer(kNotes);
  command.add_option("--cycles", options->run.cycles, "crashes, 1 to 1,000,000")
      ->capture_default_str()
      ->check(CLI::Range(1, 1'000'000).description(""));
  command.add_option("--synchronous", options->synchronous, "full, or off: without syncs, which must lose edits")
      ->capture_default_str()
      ->check(CLI::IsMember({"full", "off"}));
  command.add_option("--seed", options->run.seed, "of the moments and of what is forgotten")->capture_default_str();
  command.add_flag("--json", options->json, "one JSON document, schema heliograph.bench.crash/1");
  command.callback([&chosen, options, command_line] {
    chosen = [options, command_line] { return measureCrashes(*options, command_line); };
  });
}

}  // namespace helio::bench
