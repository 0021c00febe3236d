#include "bench/thresholds.h"

#include <spdlog/fmt/fmt.h>

#include "bench/culled_world.h"
#include "bench/plot.h"
#include "bench/progress.h"
#include "bench/report.h"
#include "bench/statistics.h"

namespace helio::bench {
namespace {

constexpr const char* kNotes = R"(What is measured:
  Light path guided culling in a city in which everything moves, with each of --thresholds in turn for hitboxes and
  instances to enter (theta_a, sigma_a), and a tenth of it to leave (theta_d, sigma_o): hits a tick of 1920 x 1080
  paths. Memory, counts and times are of the last --frames ticks. Then time stands still, and --samples are averaged:
  the errors are against no culling, of the same random numbers.

Examples:
  helio-bench thresholds --instances 2000 --animated 500 --size 160x90 --warmup 20 --frames 5 --samples 16
  helio-bench thresholds --instances 100000 --animated 6000 --size 1920x1080 --warmup 120 --device NVIDIA --json)";

struct ThresholdsOptions {
  CullingStage common;
  std::vector<float> thresholds = {30, 100, 300, 1000, 3000, 10000, 30000};
  uint32_t warmup = 60, frames = 20, samples = 64;
};

struct ThresholdsRun {
  float threshold = 0.0f;  // 0: no culling
  render::AccelerationUse use;
  uint32_t entries = 0, active = 0;
  double blas_triangles = 0.0, state_changes = 0.0, blas_ms = 0.0, path_trace_ms = 0.0, frame_ms = 0.0;
  Image composite, direct;
  double relative_mse = 0.0, similarity = 1.0, indirect_mse = 0.0;
};

Image without(const Image& all, const Image& part) {
  Image rest = all;
  for (size_t i = 0; i < rest.rgb.size(); ++i) rest.rgb[i] -= part.rgb[i];
  return rest;
}

Result<ThresholdsRun> measure(const ThresholdsOptions& options, const OpenStage& stage,
                              const render::ViewSettings& settings, float threshold) {
  ThresholdsRun run;
  run.threshold = threshold;
  render::CullingSettings culling;
  if (threshold > 0.0f) {
    culling.lipac.box_activate = culling.lipac.own_activate = threshold;
    culling.lipac.box_deactivate = culling.lipac.own_deactivate = 0.1f * threshold;
  }
  const auto world = CulledWorld::open(*stage.renderer, stage.scene, stage.camera->environment,
                                       threshold > 0.0f ? render::Culling::lipac : render::Culling::full, culling);
  if (!world) return world.error();
  const scene::Camera& camera = stage.camera->camera;
  render::ViewSettings live = settings;
  live.keep_radiance = false;
  std::vector<double> triangles, changes, blas, trace, whole;
  for (uint32_t t = 0; t < options.warmup + options.frames; ++t) {
    const auto frame = (*world)->tick(camera, live);
    if (!frame) return frame.error();
    if (t < options.warmup) continue;
    const render::FrameStats& stats = frame->stats;
    triangles.push_back(static_cast<double>(stats.acceleration.blas_triangles));
    changes.push_back(stats.lipac ? stats.lipac->changes : 0.0);
    blas.push_back(passMs(stats, {"pose", "deform", "blas"}));
    trace.push_back(passMs(stats, {"path_trace"}));
    whole.push_back(stats.gpu_ms);
    run.use = stats.acceleration;
    run.entries = stats.tlas_instances;
    run.active = stats.lipac ? stats.lipac->active : stats.tlas_instances;
  }
  run.blas_triangles = median(triangles);
  run.state_changes = median(changes);
  run.blas_ms = median(blas);
  run.path_trace_ms = median(trace);
  run.frame_ms = median(whole);
  render::ViewSettings direct = settings;
  direct.bounces = 0;
  auto composite = (*world)->still({&camera, 1}, settings, options.samples);
  if (!composite) return composite.error();
  auto lit = (*world)->still({&camera, 1}, direct, options.samples);
  if (!lit) return lit.error();
  run.composite = std::move(*composite);
  run.direct = std::move(*lit);
  return run;
}

std::string name(const ThresholdsRun& run) {
  return run.threshold > 0.0f ? fmt::format("{:g}", run.threshold) : "no culling";
}

Result<void> measureThresholds(const ThresholdsOptions& options, const std::string& command_line) {
  const auto settings = viewSettings(options.common);
  if (!settings) return settings.error();
  const auto stage = openStage(options.common);
  if (!stage) return stage.error();
  const Provenance source = provenance(stage->renderer->device(), command_line);
  std::vector<float> thresholds{0.0f};
  thresholds.insert(thresholds.end(), options.thresholds.begin(), options.thresholds.end());
  std::vector<ThresholdsRun> runs;
  {
    Progress progress("sweeping", thresholds.size());
    for (const float threshold : thresholds) {
      auto run = measure(options, *stage, *settings, threshold);
      if (!run) return run.error();
      runs.push_back(std::move(*run));
      ThresholdsRun &now = runs.back(), &truth = runs.front();
      now.relative_mse = relativeMse(now.composite, truth.composite);
      now.similarity = ssim(now.composite, truth.composite);
      now.indirect_mse = relativeMse(without(now.composite, now.direct), without(truth.composite, truth.direct));
      progress.step();
    }
  }

  Json json = {{"schema", "heliograph.bench.thresholds/1"}};
  append(json, source);
  json["camera"] = stage->camera->name;
  json["instances"] = stage->scene->placements.size();
  json["runs"] = Json::array();
  std::string text = fmt::format("# Thresholds: {}, {} instances, {}x{}\n\n", stage->camera->name,
                                 grouped(stage->scene->placements.size()), options.common.width, options.common.height);
  text += markdown(source) + "\n";
  Table table({"threshold", "active", "TLAS entries", "own BLASes", "BLAS triangles", "MB", "MB, shared BLASes apart",
               "changes", "skin and BLAS, ms", "path trace, ms", "frame, ms", "relative MSE", "SSIM", "indirect"});
  std::vector<Chart> charts{{"MB for ray tracing, shared BLASes apart", "log10 of the threshold", {{"MB", {}}}},
                            {"BLAS triangles a tick", "log10 of the threshold", {{"triangles", {}}}},
                            {"Relative MSE", "log10 of the threshold", {{"composite", {}}, {"indirect light", {}}}}};
  for (const ThresholdsRun& run : runs) {
    const uint64_t apart = run.use.total() - run.use.shared_blas_bytes;
    json["runs"].push_back({{"threshold", run.threshold},
                            {"active", run.active},
                            {"tlas_entries", run.entries},
                            {"own_blases", run.use.own_blases},
                            {"blas_triangles", run.blas_triangles},
                            {"rt_memory_bytes", run.use.total()},
                            {"shared_blas_bytes", run.use.shared_blas_bytes},
                            {"state_changes", run.state_changes},
                            {"blas_ms", run.blas_ms},
                            {"path_trace_ms", run.path_trace_ms},
                            {"frame_ms", run.frame_ms},
                            {"relative_mse", run.relative_mse},
                            {"ssim", run.similarity},
                            {"indirect_relative_mse", run.indirect_mse}});
    table.add({name(run), grouped(run.active), grouped(run.entries), grouped(run.use.own_blases),
               grouped(static_cast<uint64_t>(run.blas_triangles)), megabytes(run.use.total()), megabytes(apart),
               fixed(run.state_changes, 0), fixed(run.blas_ms, 2), fixed(run.path_trace_ms, 2), fixed(run.frame_ms, 2),
               fmt::format("{:.2e}", run.relative_mse), fixed(run.similarity, 4),
               fmt::format("{:.2e}", run.indirect_mse)});
    if (run.threshold == 0.0f) continue;
    const double x = std::log10(run.threshold);
    charts[0].series[0].points.emplace_back(x, static_cast<double>(apart) / 1e6);
    charts[1].series[0].points.emplace_back(x, run.blas_triangles);
    charts[2].series[0].points.emplace_back(x, run.relative_mse);
    charts[2].series[1].points.emplace_back(x, run.indirect_mse);
  }
  return publish(options.common, json.dump(2), text + table.markdown(), toSvg(charts));
}

}  // namespace

void addThresholdsCommand(CLI::App& app, const std::string& command_line, Action& chosen) {
  const auto options = std::make_shared<ThresholdsOptions>();
  CLI::App& command = *app.add_subcommand("thresholds", "sweeps the thresholds of culling: memory, BLAS work, error");
  command.footer(kNotes);
  addCullingStageOptions(command, options->common, "heliograph.bench.thresholds/1");
  command.add_option("--thresholds", options->thresholds, "hits, 20 to 30,000, ascending")
      ->delimiter(',')
      ->capture_default_str()
      ->check(CLI::Range(20.0, 30'000.0).description(""));
  command.add_option("--warmup", options->warmup, "ticks before the first measured one")->capture_default_str();
  command.add_option("--frames", options->frames, "measured, 1 to 10,000")
      ->capture_default_str()
      ->check(CLI::Range(1, 10'000).description(""));
  command.add_option("--samples", options->samples, "a pixel, averaged for the errors; a multiple of 8")
      ->capture_default_str()
      ->check(CLI::Range(8, 1'000'000).description(""));
  command.callback([&chosen, options, command_line] {
    chosen = [options, command_line] { return measureThresholds(*options, command_line); };
  });
}

}  // namespace helio::bench
