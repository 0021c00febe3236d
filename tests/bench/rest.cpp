#include "bench/rest.h"

#include <spdlog/fmt/fmt.h>
#include <algorithm>

#include "bench/culled_world.h"
#include "bench/plot.h"
#include "bench/progress.h"
#include "bench/report.h"
#include "shared/lipac.h"

namespace helio::bench {
namespace {

constexpr const char* kNotes = R"(What is measured:
  A city whose clock stands, seen by a camera that rests: how many instances change their state in ticks --warmup to
  --warmup + --frames, and how many of those entered and left. lipac, and the paper's rules to the letter beside it.

Examples:
  helio-bench rest --instances 2000 --animated 500 --size 160x90 --warmup 30 --frames 30
  helio-bench rest --instances 100000 --animated 6000 --size 1920x1080 --device NVIDIA --json)";

bool isActive(const render::CulledInstance& instance) { return instance.state == shared::kStateActive; }

struct RestOptions {
  CullingStage common;
  uint32_t warmup = 120, frames = 240;
};

struct RestRun {
  uint64_t instances = 0;
  uint64_t changed = 0;    // instances
  uint64_t went_back = 0;  // those of them that entered the TLAS and left it again, or the other way round
  uint32_t most = 0;       // times that one entered or left
  Series by_tick;          // instances that changed in a tick
};

Result<RestRun> measure(const RestOptions& options, const OpenStage& stage, const render::ViewSettings& settings,
                        bool literal, Progress& progress) {
  render::CullingSettings culling;
  culling.lipac.literal = literal;
  const auto world =
      CulledWorld::open(*stage.renderer, stage.scene, stage.camera->environment, render::Culling::lipac, culling);
  if (!world) return world.error();
  RestRun run{stage.scene->placements.size(), 0, 0, 0, {literal ? "lipac_literal" : "lipac", {}}};
  std::vector<render::CulledInstance> before;
  std::vector<bool> changed_at_all;
  std::vector<uint32_t> passages;
  for (uint32_t t = 0; t < options.warmup + options.frames; ++t, progress.step()) {
    if (const auto frame = (*world)->tick(stage.camera->camera, settings, 0.0); !frame) return frame.error();
    if (t + 1 < options.warmup) continue;
    auto now = (*world)->instances();
    if (!now) return now.error();
    changed_at_all.resize(now->size());
    passages.resize(now->size());
    uint32_t changed = 0;
    for (size_t slot = 0; slot < before.size(); ++slot) {
      if ((*now)[slot].state == before[slot].state) continue;
      ++changed;
      changed_at_all[slot] = true;
      passages[slot] += isActive((*now)[slot]) != isActive(before[slot]);
    }
    if (!before.empty()) run.by_tick.points.emplace_back(t, changed);
    before = std::move(*now);
  }
  run.changed = static_cast<uint64_t>(std::count(changed_at_all.begin(), changed_at_all.end(), true));
  for (const uint32_t count : passages) {
    run.went_back += count > 1;
    run.most = std::max(run.most, count);
  }
  return run;
}

Result<void> measureRest(const RestOptions& options, const std::string& command_line) {
  auto settings = viewSettings(options.common);
  if (!settings) return settings.error();
  settings->keep_radiance = false;
  const auto stage = openStage(options.common);
  if (!stage) return stage.error();
  const Provenance source = provenance(stage->renderer->device(), command_line);
  std::vector<RestRun> runs;
  {
    Progress progress("resting", 2 * (options.warmup + options.frames));
    for (const bool literal : {false, true}) {
      auto run = measure(options, *stage, *settings, literal, progress);
      if (!run) return run.error();
      runs.push_back(std::move(*run));
    }
  }
  Json json = {{"schema", "heliograph.bench.rest/1"}};
  append(json, source);
  json["camera"] = stage->camera->name;
  json["warmup"] = options.warmup;
  json["frames"] = options.frames;
  json["runs"] = Json::array();
  std::string text = fmt::format("# At rest: {}, {} instances, {}x{}, ticks {} to {}\n\n", stage->camera->name,
                                 grouped(runs.front().instances), options.common.width, options.common.height,
                                 options.warmup, options.warmup + options.frames);
  text += markdown(source) + "\n";
  Table table({"rules", "instances that change", "%", "that went back", "most passages of one"});
  std::vector<Chart> charts{{"Instances that change state", "tick", {}}};
  for (const RestRun& run : runs) {
    const double share = 100.0 * static_cast<double>(run.changed) / static_cast<double>(run.instances);
    json["runs"].push_back({{"rules", run.by_tick.name},
                            {"instances", run.instances},
                            {"changed", run.changed},
                            {"changed_percent", share},
                            {"went_back", run.went_back},
                            {"most_passages", run.most}});
    table.add({run.by_tick.name, grouped(run.changed), fixed(share, 3), grouped(run.went_back), grouped(run.most)});
    charts.front().series.push_back(run.by_tick);
  }
  return publish(options.common, json.dump(2), text + table.markdown(), toSvg(charts));
}

}  // namespace

void addRestCommand(CLI::App& app, const std::string& command_line, Action& chosen) {
  const auto options = std::make_shared<RestOptions>();
  CLI::App& command = *app.add_subcommand("rest", "instances that change state while camera and clock stand");
  command.footer(kNotes);
  addCullingStageOptions(command, options->common, "heliograph.bench.rest/1");
  command.add_option("--warmup", options->warmup, "ticks before the first that counts, 1 to 10,000")
      ->capture_default_str()
      ->check(CLI::Range(1, 10'000).description(""));
  command.add_option("--frames", options->frames, "that count, 1 to 10,000")
      ->capture_default_str()
      ->check(CLI::Range(1, 10'000).description(""));
  command.callback([&chosen, options, command_line] {
    chosen = [options, command_line] { return measureRest(*options, command_line); };
  });
}

}  // namespace helio::bench
