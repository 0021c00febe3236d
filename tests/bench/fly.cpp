#include "bench/fly.h"

#include <spdlog/fmt/fmt.h>

#include "bench/culled_world.h"
#include "bench/flight.h"
#include "bench/plot.h"
#include "bench/progress.h"
#include "bench/report.h"
#include "bench/statistics.h"

namespace helio::bench {
namespace {

constexpr const char* kNotes = R"(What is measured:
  Light path guided culling while the camera flies, turns and tilts quickly: ten seconds at 60 ticks each, unless
  --frames says otherwise, from --camera and back to it. Tick by tick, on the CPU: processing the GPU's commands, finding
  what comes into sight, recording the updates of culling's tables; on the GPU: table updates (pass instances), BLASes
  (pass blas), the frame.

Examples:
  helio-bench fly --instances 2000 --animated 500 --size 160x90 --frames 60 --plot fly.svg
  helio-bench fly --instances 100000 --animated 6000 --size 1920x1080 --device NVIDIA --json --plot fly.svg)";

struct FlyOptions {
  CullingStage common;
  uint32_t frames = 600;
  uint32_t warmup = 60;
  bool mitigation = true;
};

struct Quantity {
  const char* key;
  const char* label;
  double (*value)(const render::FrameStats&);
};
using Stats = render::FrameStats;
constexpr Quantity kQuantities[] = {
    {"commands_ms", "process commands, CPU ms", [](const Stats& f) { return f.lipac->commands_ms; }},
    {"sight_ms", "find what comes into sight, CPU ms", [](const Stats& f) { return f.lipac->sight_ms; }},
    {"upload_ms", "record table updates, CPU ms", [](const Stats& f) { return f.lipac->upload_ms; }},
    {"instances_ms", "table updates, GPU ms", [](const Stats& f) { return passMs(f, {"instances"}); }},
    {"blas_ms", "BLASes, GPU ms", [](const Stats& f) { return passMs(f, {"blas"}); }},
    {"culling_ms", "assemble and feedback, GPU ms",
     [](const Stats& f) {
       return passMs(f, {"assemble", "feedback"});
     }},
    {"frame_ms", "frame, GPU ms", [](const Stats& f) { return f.gpu_ms; }},
    {"wanted", "BLASes asked for by hits", [](const Stats& f) { return double(f.lipac->wanted); }},
    {"shown", "BLASes brought by sight", [](const Stats& f) { return double(f.lipac->shown); }},
    {"left_over", "left over by the budget",
     [](const Stats& f) { return double(f.lipac->left_over + f.lipac->unshown); }},
    {"opened", "hitboxes opened by sight", [](const Stats& f) { return double(f.lipac->opened); }},
    {"changes", "state changes", [](const Stats& f) { return double(f.lipac->changes); }},
    {"active", "active instances", [](const Stats& f) { return double(f.lipac->active); }},
    {"blas_triangles", "BLAS triangles", [](const Stats& f) { return double(f.acceleration.blas_triangles); }}};
constexpr size_t kFirstCount = 7;  // of kQuantities that is no time

Result<void> measureFly(const FlyOptions& options, const std::string& command_line) {
  auto settings = viewSettings(options.common);
  if (!settings) return settings.error();
  settings->keep_radiance = false;
  const auto stage = openStage(options.common);
  if (!stage) return stage.error();
  const Provenance source = provenance(stage->renderer->device(), command_line);
  render::CullingSettings culling;
  culling.lipac.mitigation = options.mitigation;
  const auto world =
      CulledWorld::open(*stage->renderer, stage->scene, stage->camera->environment, render::Culling::lipac, culling);
  if (!world) return world.error();

  std::vector<std::vector<double>> values(std::size(kQuantities));
  Progress progress("flying", options.warmup + options.frames);
  for (uint32_t t = 0; t < options.warmup + options.frames; ++t, progress.step()) {
    const double share = t < options.warmup ? 0.0 : double(t - options.warmup) / options.frames;
    const auto frame = (*world)->tick(along(stage->camera->camera, share), *settings);
    if (!frame) return frame.error();
    if (t < options.warmup) continue;
    for (size_t q = 0; q < values.size(); ++q) values[q].push_back(kQuantities[q].value(frame->stats));
  }

  Json json = {{"schema", "heliograph.bench.fly/1"}};
  append(json, source);
  json["camera"] = stage->camera->name;
  json["instances"] = stage->scene->placements.size();
  json["mitigation"] = options.mitigation;
  std::string text = fmt::format("# Fly: {}, {} instances, {}x{}, {} ticks, mitigation {}\n\n", stage->camera->name,
                                 grouped(stage->scene->placements.size()), options.common.width, options.common.height,
                                 options.frames, options.mitigation ? "on" : "off");
  text += markdown(source) + "\n";
  Table table({"", "median", "95th percentile", "worst"});
  std::vector<Chart> charts{
      {"CPU, ms", "seconds", {}}, {"GPU, ms", "seconds", {}}, {"Instances and BLASes", "seconds", {}}};
  for (size_t q = 0; q < values.size(); ++q) {
    const Quantity& quantity = kQuantities[q];
    const double worst = *std::max_element(values[q].begin(), values[q].end());
    const Summary summary = summarise(values[q]);
    json["series"][quantity.key] = values[q];
    const int digits = q < kFirstCount ? 3 : 0;
    table.add({quantity.label, fixed(summary.median, digits), fixed(summary.p95, digits), fixed(worst, digits)});
    Series series{quantity.key, {}};
    for (size_t t = 0; t < values[q].size(); ++t)
      series.points.emplace_back(static_cast<double>(t) * CulledWorld::kTick, values[q][t]);
    if (q < 3) charts[0].series.push_back(std::move(series));
    else if (q < kFirstCount - 1) charts[1].series.push_back(std::move(series));
    else if (q >= kFirstCount && q < kFirstCount + 4) charts[2].series.push_back(std::move(series));
  }
  return publish(options.common, json.dump(2), text + table.markdown(), toSvg(charts));
}

}  // namespace

void addFlyCommand(CLI::App& app, const std::string& command_line, Action& chosen) {
  const auto options = std::make_shared<FlyOptions>();
  CLI::App& command = *app.add_subcommand("fly", "ten seconds of quick flight: what culling costs, tick by tick");
  command.footer(kNotes);
  addCullingStageOptions(command, options->common, "heliograph.bench.fly/1");
  command.add_option("--frames", options->frames, "of the whole path, 2 to 10,000")
      ->capture_default_str()
      ->check(CLI::Range(2, 10'000).description(""));
  command.add_option("--warmup", options->warmup, "ticks at its start")->capture_default_str();
  command.add_option("--mitigation", options->mitigation, "of latency: true or false")->capture_default_str();
  command.callback([&chosen, options, command_line] {
    chosen = [options, command_line] { return measureFly(*options, command_line); };
  });
}

}  // namespace helio::bench
