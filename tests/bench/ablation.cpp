#include "bench/ablation.h"

#include <spdlog/fmt/fmt.h>

#include "bench/culled_world.h"
#include "bench/plot.h"
#include "bench/progress.h"
#include "bench/report.h"
#include "bench/statistics.h"

namespace helio::bench {
namespace {

constexpr const char* kNotes = R"(What is measured:
  R: primary hits are rasterised instead of traced. L: light path guided culling instead of everything in the TLAS. S:
  what is culled casts the sun's shadow by a shadow map; without L nothing is culled, so S stands with L alone. Every
  combination has a world of its own, and their ticks alternate, so whatever slows the machine down meets all alike.
  Then time stands still: errors are against the same primary hits without L and S, of the same random numbers.

Examples:
  helio-bench ablation --instances 2000 --animated 500 --size 160x90 --warmup 20 --frames 5 --samples 16
  helio-bench ablation --instances 100000 --animated 6000 --size 1920x1080 --warmup 120 --device NVIDIA --json)";

struct AblationOptions {
  CullingStage common;
  uint32_t warmup = 60, frames = 20, samples = 64;
};

struct Combination {
  const char* name;
  bool raster, culled, mapped;
};
// The one without culling comes ahead of those with the same primary hits.
constexpr Combination kCombinations[] = {{"none", false, false, false}, {"L", false, true, false},
                                         {"L+S", false, true, true},    {"R", true, false, false},
                                         {"R+L", true, true, false},    {"R+L+S", true, true, true}};

struct AblationRun {
  const Combination* combination = nullptr;
  std::unique_ptr<CulledWorld> world;
  render::ViewSettings settings;
  std::vector<double> blas, structure, primary, trace, shadow, whole;
  render::AccelerationUse use;
  double relative_mse = 0.0, similarity = 1.0;
};

void note(AblationRun& run, const render::FrameStats& stats) {
  run.blas.push_back(passMs(stats, {"pose", "deform", "blas"}));
  run.structure.push_back(passMs(stats, {"assemble", "tlas", "feedback"}));
  run.primary.push_back(passMs(stats, {"cull", "primary_raster", "primary_traced"}));
  run.trace.push_back(passMs(stats, {"path_trace"}));
  run.shadow.push_back(passMs(stats, {"shadow_cull", "shadow_map"}));
  run.whole.push_back(stats.gpu_ms);
  run.use = stats.acceleration;
}

Result<void> measureAblation(const AblationOptions& options, const std::string& command_line) {
  const auto settings = viewSettings(options.common);
  if (!settings) return settings.error();
  const auto stage = openStage(options.common);
  if (!stage) return stage.error();
  const Provenance source = provenance(stage->renderer->device(), command_line);
  const scene::Camera& camera = stage->camera->camera;

  std::vector<AblationRun> runs;
  for (const Combination& combination : kCombinations) {
    auto world = CulledWorld::open(*stage->renderer, stage->scene, stage->camera->environment,
                                   combination.culled ? render::Culling::lipac : render::Culling::full);
    if (!world) return world.error();
    AblationRun& run = runs.emplace_back();
    run.combination = &combination;
    run.world = std::move(*world);
    run.settings = *settings;
    run.settings.primary = combination.raster ? render::Primary::raster : render::Primary::traced;
    if (combination.mapped) run.settings.sun_shadow = render::SunShadow::rays_and_map;
  }
  {
    Progress progress("measuring", options.warmup + options.frames);
    for (uint32_t t = 0; t < options.warmup + options.frames; ++t, progress.step())
      for (AblationRun& run : runs) {
        render::ViewSettings live = run.settings;
        live.keep_radiance = false;
        const auto frame = run.world->tick(camera, live);
        if (!frame) return frame.error();
        if (t >= options.warmup) note(run, frame->stats);
      }
  }
  {
    Progress progress("comparing pictures", runs.size());
    Image truth;
    for (AblationRun& run : runs) {
      auto picture = run.world->still({&camera, 1}, run.settings, options.samples);
      if (!picture) return picture.error();
      if (!run.combination->culled) truth = std::move(*picture);
      else {
        run.relative_mse = relativeMse(*picture, truth);
        run.similarity = ssim(*picture, truth);
      }
      progress.step();
    }
  }

  Json json = {{"schema", "heliograph.bench.ablation/1"}};
  append(json, source);
  json["camera"] = stage->camera->name;
  json["instances"] = stage->scene->placements.size();
  json["runs"] = Json::array();
  std::string text = fmt::format("# Ablation: {}, {} instances, {}x{}\n\n", stage->camera->name,
                                 grouped(stage->scene->placements.size()), options.common.width, options.common.height);
  text += markdown(source);
  text += "- R: rasterised primary hits; L: light path guided culling; S: a shadow map of what it culls\n\n";
  Table table({"", "frame, ms", "primary hits, ms", "path trace, ms", "shadow map, ms", "skin and BLAS, ms",
               "assemble, TLAS, feedback, ms", "BLAS triangles", "MB for ray tracing", "relative MSE", "SSIM"});
  Chart chart{"ms, by combination: " + stage->camera->name,
              "none, L, L+S, R, R+L, R+L+S",
              {{"frame", {}}, {"path trace", {}}, {"primary hits", {}}, {"shadow map", {}}}};
  for (size_t i = 0; i < runs.size(); ++i) {
    const AblationRun& run = runs[i];
    json["runs"].push_back({{"combination", run.combination->name},
                            {"frame_ms", median(run.whole)},
                            {"primary_ms", median(run.primary)},
                            {"path_trace_ms", median(run.trace)},
                            {"shadow_ms", median(run.shadow)},
                            {"blas_ms", median(run.blas)},
                            {"structure_ms", median(run.structure)},
                            {"blas_triangles", run.use.blas_triangles},
                            {"rt_memory_bytes", run.use.total()},
                            {"relative_mse", run.relative_mse},
                            {"ssim", run.similarity}});
    table.add({run.combination->name, fixed(median(run.whole), 2), fixed(median(run.primary), 2),
               fixed(median(run.trace), 2), fixed(median(run.shadow), 2), fixed(median(run.blas), 2),
               fixed(median(run.structure), 2), grouped(run.use.blas_triangles), megabytes(run.use.total()),
               run.combination->culled ? fmt::format("{:.2e}", run.relative_mse) : "-",
               run.combination->culled ? fixed(run.similarity, 4) : "-"});
    const std::vector<double>* const lines[] = {&run.whole, &run.trace, &run.primary, &run.shadow};
    for (size_t line = 0; line < std::size(lines); ++line)
      chart.series[line].points.emplace_back(static_cast<double>(i), median(*lines[line]));
  }
  return publish(options.common, json.dump(2), text + table.markdown(), toSvg({chart}));
}

}  // namespace

void addAblationCommand(CLI::App& app, const std::string& command_line, Action& chosen) {
  const auto options = std::make_shared<AblationOptions>();
  CLI::App& command = *app.add_subcommand(
      "ablation", "rasterised primary hits, culling and the shadow map of what it culls, each alone and together");
  command.footer(kNotes);
  addCullingStageOptions(command, options->common, "heliograph.bench.ablation/1");
  command.add_option("--warmup", options->warmup, "ticks before the first measured one")->capture_default_str();
  command.add_option("--frames", options->frames, "measured, 1 to 10,000")
      ->capture_default_str()
      ->check(CLI::Range(1, 10'000).description(""));
  command.add_option("--samples", options->samples, "a pixel, averaged for the errors; a multiple of 8")
      ->capture_default_str()
      ->check(CLI::Range(8, 1'000'000).description(""));
  command.callback([&chosen, options, command_line] {
    chosen = [options, command_line] { return measureAblation(*options, command_line); };
  });
}

}  // namespace helio::bench
