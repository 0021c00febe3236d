// helio-load: scripted clients against a server, and whether it kept its promises.
#include <unistd.h>
#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <iostream>

#include "load/report.h"
#include "load/spawned_server.h"

namespace {

using namespace helio;
using namespace helio::load;

constexpr int kMissed = 1, kFailed = 2;

constexpr const char* kExamples = R"(Examples:
  helio-load tests/load/smoke.yaml --spawn synthetic
  helio-load tests/load/jumps.yaml --spawn lavapipe --html jumps.html
  helio-load tests/load/crowd.yaml --server 127.0.0.1:7700 --json now.json --baseline before.json
Exit status: 0 every objective is met, 1 one is missed, 2 it could not be measured.
A scenario makes its worlds and deletes them. Servers on loopback only: a load test is not for other people's machines.
tests/load/README.md documents scenarios, metrics and the JSON document.)";

struct Options {
  std::string scenario, server, spawn, json, junit, html, baseline;
  double max_regression = -1;
};

/// Caught by main: one line on standard error, exit status 2.
struct Stop {
  std::string message;
};

template <typename T>
T get(Result<T> result) {
  if (!result) throw Stop{result.error().message};
  return std::move(*result);
}

void writeFile(const std::string& path, const std::string& bytes) {
  if (path.empty()) return;
  std::ofstream file(path, std::ios::binary);
  file << bytes;
  if (!file.flush()) throw Stop{"cannot write " + path + "; does its folder exist, and is there space?"};
}

void refuseOtherMachines(const std::string& server) {
  const std::string host = server.substr(0, server.rfind(':'));
  if (host != "localhost" && host != "[::1]" && host.rfind("127.", 0) != 0)
    throw Stop{"--server is " + server + ", which is not on loopback; start helio-load on the server's machine"};
}

std::string commandLine(int argc, char** argv) {
  std::string out = "helio-load";
  for (int i = 1; i < argc; ++i) out += std::string(" ") + argv[i];
  return out;
}

std::string now() {
  const std::time_t time = std::time(nullptr);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", std::gmtime(&time));
  return text;
}

/// One line that is written over, on a terminal; elsewhere a line every five seconds.
class ProgressLine {
 public:
  void show(const std::string& what, const Progress& progress) {
    const bool due = terminal_ || progress.seconds >= next_;
    if (!due) return;
    const double seconds = std::max(progress.seconds - last_.seconds, 1e-3);
    char text[200];
    std::snprintf(text, sizeof text, "%s%5.0f s of %.0f: %.0f frames/s, %.1f edits/s, %llu steps, %llu failed",
                  what.c_str(), progress.seconds, progress.duration,
                  double(progress.counts.frames - last_.counts.frames) / seconds,
                  double(progress.counts.acknowledged_edits - last_.counts.acknowledged_edits) / seconds,
                  static_cast<unsigned long long>(progress.counts.steps),
                  static_cast<unsigned long long>(progress.counts.failed_steps + progress.counts.ended_streams));
    std::cerr << (terminal_ ? "\r\033[K" : "") << text << (terminal_ ? "" : "\n") << std::flush;
    last_ = progress;
    next_ = progress.seconds + 5;
  }
  void end() {
    if (terminal_) std::cerr << "\r\033[K";
    last_ = {};
    next_ = 0;
  }

 private:
  const bool terminal_ = isatty(STDERR_FILENO) != 0;
  Progress last_;
  double next_ = 0;
};

std::unique_ptr<SpawnedServer> spawn(const std::string& kind, const Scenario& scenario) {
  const auto program = std::filesystem::read_symlink("/proc/self/exe").parent_path() / "heliographd";
  std::vector<std::string> flags = {"--renderer", "vulkan", "--device", "cpu"};
  if (kind == "synthetic")
    flags = {"--renderer",           "synthetic",
             "--synthetic-frame-us", std::to_string(scenario.synthetic_frame_us),
             "--synthetic-noise",    std::to_string(scenario.synthetic_noise)};
  return get(SpawnedServer::start(program, flags));
}

std::vector<RunResult> play(const Options& options, const Scenario& scenario) {
  const std::vector<std::string> variants =
      scenario.variants.empty() ? std::vector<std::string>{""} : scenario.variants;
  std::vector<RunResult> runs;
  ProgressLine line;
  for (uint32_t round = 1; round <= scenario.rounds; ++round)
    for (const auto& variant : variants) {
      // A fresh server for every run: memory that one has left would be counted against the next.
      const auto spawned = options.spawn.empty() ? nullptr : spawn(options.spawn, scenario);
      std::string what = scenario.name;
      if (scenario.rounds > 1) what += " round " + std::to_string(round);
      if (!variant.empty()) what += ", " + variant;
      const auto show = [&](const Progress& progress) { line.show(what, progress); };
      runs.push_back(get(run(scenario, variant, round, spawned ? spawned->address() : options.server, show)));
      line.end();
    }
  return runs;
}

/// Objectives of --max-regression: a figure may not be so much worse than the baseline's.
void holdToBaseline(const std::vector<Change>& changes, double percent, std::vector<Judged>& judged) {
  for (const Change& change : changes)
    if (change.before > 0)
      judged.push_back({change.statistic + " of " + change.series + " of " + change.group + " against the baseline",
                        change.percent(), percent, true, change.percent() <= percent, "per cent"});
}

int perform(const Options& options, const std::string& command) {
  const Scenario scenario = get(readScenario(options.scenario));
  if (!options.server.empty()) refuseOtherMachines(options.server);
  Json baseline;
  if (!options.baseline.empty()) {
    baseline = Json::parse(std::ifstream(options.baseline), nullptr, /*allow_exceptions=*/false);
    if (baseline.is_discarded()) throw Stop{"--baseline: " + options.baseline + " cannot be read, or is not JSON"};
  }
  const Provenance provenance{command, now()};
  const auto runs = play(options, scenario);
  auto judged = judge(scenario, runs);
  Json report = reportOf(scenario, runs, judged, provenance);
  if (!options.baseline.empty()) {
    const auto changes = get(compare(baseline, report));
    if (options.max_regression >= 0) {
      holdToBaseline(changes, options.max_regression, judged);
      report = reportOf(scenario, runs, judged, provenance);
    }
    append(report, changes);
  }
  writeFile(options.json, report.dump(1) + "\n");
  writeFile(options.junit, junitOf(report));
  writeFile(options.html, pageOf(report));
  std::cout << scenario.name << (report["met"] ? ": every objective is met\n" : ": an objective is MISSED\n")
            << textOf(report);
  return report["met"] ? EXIT_SUCCESS : kMissed;
}

}  // namespace

int main(int argc, char** argv) {
  std::signal(SIGPIPE, SIG_IGN);
  Options options;
  CLI::App app("Plays a scenario with scripted clients, and says whether its objectives are met.", "helio-load");
  app.footer(kExamples);
  app.add_option("scenario", options.scenario, "the scenario, YAML")->required();
  auto* server = app.add_option("--server", options.server, "host:port of a running server, on loopback");
  app.add_option("--spawn", options.spawn, "start a server for each run: synthetic or lavapipe")
      ->excludes(server)
      ->check(CLI::IsMember({"synthetic", "lavapipe"}));
  app.add_option("--json", options.json, "write the report, schema heliograph.load/1");
  app.add_option("--junit", options.junit, "write a JUnit file: one test case an objective");
  app.add_option("--html", options.html, "write a page with plots that needs no other file");
  auto* baseline = app.add_option("--baseline", options.baseline, "an earlier JSON report to compare with");
  app.add_option("--max-regression", options.max_regression,
                 "per cent by which p50 and p99 of a series may be worse than the baseline's")
      ->needs(baseline)
      ->check(CLI::NonNegativeNumber);
  try {
    app.parse(argc, argv);
    if (options.server.empty() && options.spawn.empty())
      throw Stop{"give --server HOST:PORT, or --spawn synthetic; see helio-load --help"};
    return perform(options, commandLine(argc, argv));
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);
    std::cerr << "helio-load: " << error.what() << "; see helio-load --help\n";
  } catch (const Stop& stop) {
    std::cerr << "helio-load: " << stop.message << "\n";
  } catch (const std::exception& error) { std::cerr << "helio-load: " << error.what() << "\n"; }
  return kFailed;
}
