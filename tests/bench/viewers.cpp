#include "bench/viewers.h"

#include <spdlog/fmt/fmt.h>
#include <algorithm>
#include <numeric>

#include "bench/culled_world.h"
#include "bench/plot.h"
#include "bench/progress.h"
#include "bench/report.h"
#include "bench/statistics.h"

namespace helio::bench {
namespace {

constexpr const char* kNotes = R"(What is measured:
  N viewers of one world with light path guided culling, against N worlds with one viewer each, in ticks in which
  everything moves. near: they stand 3 m apart and look the same way. far: each at another of the scene's cameras, a
  second round 150 m further on. Memory is that of ray tracing; shared BLASes stand apart, in JSON. Times are of one tick for all viewers together. The error is the first viewer's, against a world without
  culling: company must not make it grow.

Examples:
  helio-bench viewers --viewers 1,2 --instances 2000 --animated 500 --size 160x90 --frames 5 --warmup 20 --samples 16
  helio-bench viewers --spread far --instances 100000 --animated 6000 --size 1280x720 --device NVIDIA --json)";

struct ViewersOptions {
  CullingStage common;
  std::vector<uint32_t> viewers = {1, 2, 4, 8};
  std::string spread = "near";
  uint32_t warmup = 60, frames = 20, samples = 64;
};

/// Of all viewers of a tick together.
struct Cost {
  uint64_t rt_bytes = 0, shared_blas_bytes = 0;
  double blas_triangles = 0.0, active = 0.0, world_ms = 0.0, tick_ms = 0.0;
};

struct ViewersRun {
  uint32_t viewers = 0;
  Cost shared, separate;
  double relative_mse = 0.0;  // of the first viewer
};

constexpr auto kWorldPasses = {"instances", "emitters", "pose", "deform", "blas", "assemble", "tlas", "feedback"};

std::vector<scene::Camera> camerasOf(const scene::Scene& scene, const scene::NamedCamera& first, uint32_t count,
                                     bool near) {
  std::vector<scene::Camera> cameras;
  const auto own = static_cast<size_t>(&first - scene.cameras.data());
  for (uint32_t i = 0; i < count; ++i) {
    const auto round = static_cast<float>(near ? i : i / scene.cameras.size());
    scene::Camera camera = near ? first.camera : scene.cameras[(own + i) % scene.cameras.size()].camera;
    const glm::vec3 right = glm::normalize(glm::cross(camera.forward, camera.up));
    // To both sides in turn.
    const float steps = (i % 2 == 1 ? 1.0f : -1.0f) * std::ceil(round / 2.0f);
    camera.position += right * (near ? 3.0f * steps : 150.0f * round);
    cameras.push_back(camera);
  }
  return cameras;
}

/// A number of worlds, each seen by some of the cameras.
Result<Cost> measure(std::vector<std::unique_ptr<CulledWorld>>& worlds,
                     const std::vector<std::vector<scene::Camera>>& cameras, const ViewersOptions& options,
                     const render::ViewSettings& settings, Progress& progress) {
  Cost cost;
  std::vector<double> triangles, world_ms, tick_ms;
  for (uint32_t t = 0; t < options.warmup + options.frames; ++t, progress.step()) {
    Cost tick;
    for (size_t w = 0; w < worlds.size(); ++w) {
      auto frames = worlds[w]->tick(cameras[w], settings);
      if (!frames) return frames.error();
      const render::FrameStats& first = frames->front().stats;
      const double shared = passMs(first, kWorldPasses);
      tick.world_ms += shared;
      tick.tick_ms += shared;
      for (const render::Frame& frame : *frames) tick.tick_ms += frame.stats.gpu_ms - shared;
      tick.blas_triangles += static_cast<double>(first.acceleration.blas_triangles);
      tick.rt_bytes += first.acceleration.total() - first.acceleration.shared_blas_bytes;
      tick.shared_blas_bytes += first.acceleration.shared_blas_bytes;
      tick.active += first.lipac ? first.lipac->active : 0;
    }
    if (t < options.warmup) continue;
    triangles.push_back(tick.blas_triangles);
    world_ms.push_back(tick.world_ms);
    tick_ms.push_back(tick.tick_ms);
    cost = tick;
  }
  cost.blas_triangles = median(triangles);
  cost.world_ms = median(world_ms);
  cost.tick_ms = median(tick_ms);
  return cost;
}

Json toJson(const Cost& cost) {
  return {{"rt_memory_bytes", cost.rt_bytes},      {"shared_blas_bytes", cost.shared_blas_bytes},
          {"blas_triangles", cost.blas_triangles}, {"active", cost.active},
          {"world_passes_ms", cost.world_ms},      {"tick_ms", cost.tick_ms}};
}

Result<void> measureViewers(const ViewersOptions& options, const std::string& command_line) {
  auto settings = viewSettings(options.common);
  if (!settings) return settings.error();
  const auto stage = openStage(options.common);
  if (!stage) return stage.error();
  const Provenance source = provenance(stage->renderer->device(), command_line);
  const scene::Environment& light = stage->camera->environment;
  render::ViewSettings live = *settings;
  live.keep_radiance = false;

  std::vector<ViewersRun> runs;
  for (const uint32_t count : options.viewers) {
    ViewersRun run;
    run.viewers = count;
    const auto cameras = camerasOf(*stage->scene, *stage->camera, count, options.spread == "near");
    Progress progress(fmt::format("{} viewers", count), 2 * (options.warmup + options.frames));
    const auto open = [&](render::Culling culling) {
      return CulledWorld::open(*stage->renderer, stage->scene, light, culling);
    };
    {
      std::vector<std::unique_ptr<CulledWorld>> worlds;
      auto world = open(render::Culling::lipac);
      if (!world) return world.error();
      worlds.push_back(std::move(*world));
      for (uint32_t i = 1; i < count; ++i)
        if (auto attached = worlds[0]->attach(); !attached) return attached.error();
      auto cost = measure(worlds, {cameras}, options, live, progress);
      if (!cost) return cost.error();
      run.shared = *cost;
      // The same ticks without culling, so that time and random numbers are the same.
      auto full = open(render::Culling::full);
      if (!full) return full.error();
      render::ViewSettings tiny = live;
      tiny.width = tiny.height = 16;
      for (uint32_t t = 0; t < options.warmup + options.frames; ++t)
        if (auto frame = (*full)->tick(cameras[0], tiny); !frame) return frame.error();
      auto culled = worlds[0]->still(cameras, *settings, options.samples);
      if (!culled) return culled.error();
      auto truth = (*full)->still({cameras.data(), 1}, *settings, options.samples);
      if (!truth) return truth.error();
      run.relative_mse = relativeMse(*culled, *truth);
    }
    {
      std::vector<std::unique_ptr<CulledWorld>> worlds;
      std::vector<std::vector<scene::Camera>> own;
      for (const scene::Camera& camera : cameras) {
        auto world = open(render::Culling::lipac);
        if (!world) return world.error();
        worlds.push_back(std::move(*world));
        own.push_back({camera});
      }
      auto cost = measure(worlds, own, options, live, progress);
      if (!cost) return cost.error();
      run.separate = *cost;
    }
    runs.push_back(run);
  }

  Json json = {{"schema", "heliograph.bench.viewers/1"}};
  append(json, source);
  json["camera"] = stage->camera->name;
  json["instances"] = stage->scene->placements.size();
  json["spread"] = options.spread;
  json["runs"] = Json::array();
  std::string text = fmt::format("# Viewers: {}, {}, {} instances, {}x{}\n\n", options.spread, stage->camera->name,
                                 grouped(stage->scene->placements.size()), options.common.width, options.common.height);
  text += markdown(source) + "\n";
  Table table({"viewers", "MB, one structure", "of the first row", "MB, one each", "BLAS triangles, one", "each",
               "active, one", "each", "world's passes, ms, one", "each", "tick, ms, one", "each",
               "error of the first"});
  std::vector<Chart> charts{
      {"MB for ray tracing, shared BLASes apart", "viewers", {{"one structure", {}}, {"one each", {}}}},
      {"Tick, ms", "viewers", {{"one structure", {}}, {"one each", {}}}}};
  for (const ViewersRun& run : runs) {
    const Cost &a = run.shared, &b = run.separate;
    json["runs"].push_back(
        {{"viewers", run.viewers}, {"shared", toJson(a)}, {"separate", toJson(b)}, {"relative_mse", run.relative_mse}});
    table.add({std::to_string(run.viewers), megabytes(a.rt_bytes),
               fixed(static_cast<double>(a.rt_bytes) / static_cast<double>(runs.front().shared.rt_bytes), 2),
               megabytes(b.rt_bytes), grouped(static_cast<uint64_t>(a.blas_triangles)),
               grouped(static_cast<uint64_t>(b.blas_triangles)), grouped(static_cast<uint64_t>(a.active)),
               grouped(static_cast<uint64_t>(b.active)), fixed(a.world_ms, 2), fixed(b.world_ms, 2),
               fixed(a.tick_ms, 2), fixed(b.tick_ms, 2), fmt::format("{:.2e}", run.relative_mse)});
    for (size_t i = 0; i < 2; ++i) {
      const Cost& cost = i == 0 ? a : b;
      charts[0].series[i].points.emplace_back(run.viewers, static_cast<double>(cost.rt_bytes) / 1e6);
      charts[1].series[i].points.emplace_back(run.viewers, cost.tick_ms);
    }
  }
  return publish(options.common, json.dump(2), text + table.markdown(), toSvg(charts));
}

}  // namespace

void addViewersCommand(CLI::App& app, const std::string& command_line, Action& chosen) {
  const auto options = std::make_shared<ViewersOptions>();
  CLI::App& command =
      *app.add_subcommand("viewers", "several viewers on one acceleration structure, against one for each");
  command.footer(kNotes);
  addCullingStageOptions(command, options->common, "heliograph.bench.viewers/1");
  command.add_option("--viewers", options->viewers, "how many look, 1 to 64; several numbers are runs")
      ->delimiter(',')
      ->capture_default_str()
      ->check(CLI::Range(1, 64).description(""));
  command.add_option("--spread", options->spread, "near or far")
      ->capture_default_str()
      ->check(CLI::IsMember({"near", "far"}));
  command.add_option("--warmup", options->warmup, "ticks before the first measured one")->capture_default_str();
  command.add_option("--frames", options->frames, "measured, 1 to 10,000")
      ->capture_default_str()
      ->check(CLI::Range(1, 10'000).description(""));
  command.add_option("--samples", options->samples, "a pixel, averaged for the error; a multiple of 8")
      ->capture_default_str()
      ->check(CLI::Range(8, 1'000'000).description(""));
  command.callback([&chosen, options, command_line] {
    chosen = [options, command_line] { return measureViewers(*options, command_line); };
  });
}

}  // namespace helio::bench
