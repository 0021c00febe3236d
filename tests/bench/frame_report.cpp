#include "bench/frame_report.h"

#include <algorithm>
#include <cmath>
#include <functional>

namespace helio::bench {
namespace {

using Frames = std::span<const render::FrameStats>;

std::vector<double> each(Frames frames, const std::function<double(const render::FrameStats&)>& value) {
  std::vector<double> values;
  values.reserve(frames.size());
  for (const render::FrameStats& frame : frames) values.push_back(value(frame));
  return values;
}

double passMs(const render::FrameStats& frame, const std::string& pass) {
  for (const render::PassTime& time : frame.passes)
    if (time.name == pass) return time.ms;
  return 0.0;
}

double effectMs(const render::FrameStats& frame, const std::string& effect) {
  for (const render::EffectCost& cost : frame.effects)
    if (cost.name == effect) return cost.pass_ms;
  return 0.0;
}

/// Rays traced a microsecond by the passes that trace them; primary rays count where they are traced.
double megaraysPerSecond(const render::FrameStats& frame) {
  const double ms = passMs(frame, "path_trace") + passMs(frame, "primary_traced");
  return ms > 0.0 ? static_cast<double>(frame.rays.total()) / (ms * 1e3) : 0.0;
}

uint64_t medianCount(Frames frames, uint64_t render::Rays::*kind) {
  const auto count = [kind](const render::FrameStats& frame) { return static_cast<double>(frame.rays.*kind); };
  return static_cast<uint64_t>(std::llround(median(each(frames, count))));
}

Json toJson(const Summary& summary) { return {{"median", summary.median}, {"p95", summary.p95}}; }

Json toJson(const FrameRun& run) {
  Json passes = Json::object();
  for (const auto& [pass, ms] : run.passes) passes[pass] = toJson(ms);
  Json effects = Json::array();
  for (const render::EffectCost& effect : run.effects)
    effects.push_back({{"name", effect.name},
                       {"instances", effect.instances},
                       {"memory_bytes", effect.memory_bytes},
                       {"pass_ms", effect.pass_ms}});
  const render::Rays& rays = run.rays;
  const render::MemoryUse& memory = run.memory;
  return {{"primary", name(run.primary)},
          {"frame_ms", toJson(run.frame_ms)},
          {"passes", passes},
          {"path_trace_ms", toJson(run.path_trace_ms)},
          {"bare_trace_ms", toJson(run.bare_trace_ms)},
          {"path_trace_over_bare", run.path_trace_over_bare},
          {"rays",
           {{"primary", rays.primary},
            {"bounce", rays.bounce},
            {"shadow", rays.shadow},
            {"retrace", rays.retrace},
            {"per_pixel", run.rays_per_pixel}}},
          {"mrays_per_s", run.mrays_per_s},
          {"tlas_instances", run.tlas_instances},
          {"triangles_drawn", run.triangles_drawn},
          {"nonfinite", run.nonfinite},
          {"memory",
           {{"raster_bytes", memory.raster},
            {"ray_tracing_bytes", memory.ray_tracing},
            {"path_tracing_bytes", memory.path_tracing},
            {"total_bytes", memory.raster + memory.ray_tracing + memory.path_tracing}}},
          {"effects", effects}};
}

/// Names of all runs' passes: a pass that only one run has stands where that run records it.
std::vector<std::string> passNames(const std::vector<FrameRun>& runs) {
  std::vector<std::string> names;
  for (const FrameRun& run : runs) {
    auto next = names.begin();
    for (const auto& [pass, ms] : run.passes) {
      const auto found = std::find(names.begin(), names.end(), pass);
      next = std::next(found != names.end() ? found : names.insert(next, pass));
    }
  }
  return names;
}

std::string origin(const FrameReport& report) {
  return markdown(report.provenance) +  //
         "- scene: " + report.scene + ", camera " + report.camera + ", " + grouped(report.instances) + " instances\n" +
         "- picture: " + std::to_string(report.width) + "x" + std::to_string(report.height) + ", " +
         std::to_string(report.bounces) + " bounces, mode " + name(report.mode) + "\n" +
         "- frames: " + std::to_string(report.frames) + " of each kind, after " + std::to_string(report.warmup) + "\n";
}

/// Milliseconds: two columns a run.
Table timeTable(const std::vector<FrameRun>& runs) {
  std::vector<std::string> header{"ms"};
  for (const FrameRun& run : runs)
    for (const char* column : {" median", " p95"}) header.push_back(name(run.primary) + std::string(column));
  Table table(header);
  const auto row = [&](const std::string& label, const std::function<const Summary*(const FrameRun&)>& value) {
    std::vector<std::string> cells{label};
    for (const FrameRun& run : runs) {
      const Summary* ms = value(run);
      cells.push_back(ms ? fixed(ms->median, 3) : "");
      cells.push_back(ms ? fixed(ms->p95, 3) : "");
    }
    table.add(cells);
  };
  row("frame_ms", [](const FrameRun& run) { return &run.frame_ms; });
  for (const std::string& pass : passNames(runs))
    row("- " + pass, [&pass](const FrameRun& run) -> const Summary* {
      const auto found =
          std::find_if(run.passes.begin(), run.passes.end(), [&](const auto& p) { return p.first == pass; });
      return found == run.passes.end() ? nullptr : &found->second;
    });
  row("path_trace_ms", [](const FrameRun& run) { return &run.path_trace_ms; });
  row("bare_trace_ms", [](const FrameRun& run) { return &run.bare_trace_ms; });
  return table;
}

/// Everything else: one column a run.
Table countTable(const std::vector<FrameRun>& runs) {
  std::vector<std::string> header{"a frame"};
  for (const FrameRun& run : runs) header.emplace_back(name(run.primary));
  Table table(header);
  const auto row = [&](const std::string& label, const std::function<std::string(const FrameRun&)>& value) {
    std::vector<std::string> cells{label};
    for (const FrameRun& run : runs) cells.push_back(value(run));
    table.add(cells);
  };
  row("path_trace / bare_trace", [](const FrameRun& run) { return fixed(run.path_trace_over_bare, 2); });
  row("Mrays/s", [](const FrameRun& run) { return fixed(run.mrays_per_s, 2); });
  row("rays: primary", [](const FrameRun& run) { return grouped(run.rays.primary); });
  row("rays: bounce", [](const FrameRun& run) { return grouped(run.rays.bounce); });
  row("rays: shadow", [](const FrameRun& run) { return grouped(run.rays.shadow); });
  row("rays: retrace", [](const FrameRun& run) { return grouped(run.rays.retrace); });
  row("rays a pixel", [](const FrameRun& run) { return fixed(run.rays_per_pixel, 2); });
  row("triangles drawn", [](const FrameRun& run) { return grouped(run.triangles_drawn); });
  row("TLAS instances", [](const FrameRun& run) { return grouped(run.tlas_instances); });
  row("samples not finite, all frames", [](const FrameRun& run) { return grouped(run.nonfinite); });
  row("MB that rasterising needs too", [](const FrameRun& run) { return megabytes(run.memory.raster); });
  row("MB for ray tracing", [](const FrameRun& run) { return megabytes(run.memory.ray_tracing); });
  row("MB for path tracing only", [](const FrameRun& run) { return megabytes(run.memory.path_tracing); });
  return table;
}

Table effectTable(const std::vector<FrameRun>& runs) {
  Table table({"effect", "primary", "instances", "MB", "ms"});
  for (const FrameRun& run : runs)
    for (const render::EffectCost& effect : run.effects)
      table.add({effect.name, name(run.primary), grouped(effect.instances), megabytes(effect.memory_bytes),
                 fixed(effect.pass_ms, 3)});
  return table;
}

}  // namespace

const char* name(render::Mode mode) { return mode == render::Mode::hybrid ? "hybrid" : "reference"; }
const char* name(render::Primary primary) { return primary == render::Primary::raster ? "raster" : "traced"; }

FrameRun summariseRun(render::Primary primary, Frames live, Frames bare, const render::MemoryUse& memory,
                      uint64_t pixels) {
  FrameRun run;
  run.primary = primary;
  run.frame_ms = summarise(each(live, [](const auto& frame) { return frame.gpu_ms; }));
  // The scene stands but for the mover: every frame has the passes of the last.
  for (const render::PassTime& pass : live.back().passes)
    run.passes.emplace_back(pass.name,
                            summarise(each(live, [&](const auto& frame) { return passMs(frame, pass.name); })));

  run.path_trace_ms = summarise(each(bare, [](const auto& frame) { return passMs(frame, "path_trace"); }));
  run.bare_trace_ms = summarise(each(bare, [](const auto& frame) { return frame.bare_trace_ms; }));
  run.path_trace_over_bare = median(each(bare, [](const auto& frame) {
    return frame.bare_trace_ms > 0.0 ? passMs(frame, "path_trace") / frame.bare_trace_ms : 0.0;
  }));

  run.rays = {medianCount(live, &render::Rays::primary), medianCount(live, &render::Rays::bounce),
              medianCount(live, &render::Rays::shadow), medianCount(live, &render::Rays::retrace)};
  run.rays_per_pixel = median(each(live, [](const auto& frame) { return static_cast<double>(frame.rays.total()); })) /
                       static_cast<double>(pixels);
  run.mrays_per_s = median(each(live, megaraysPerSecond));
  run.tlas_instances = live.back().tlas_instances;
  run.triangles_drawn = live.back().triangles_drawn;
  for (const Frames frames : {live, bare})
    for (const render::FrameStats& frame : frames) run.nonfinite += frame.nonfinite;
  run.memory = memory;
  run.effects = live.back().effects;
  for (render::EffectCost& effect : run.effects)
    effect.pass_ms = median(each(live, [&](const auto& frame) { return effectMs(frame, effect.name); }));
  return run;
}

Json toJson(const FrameReport& report) {
  Json json;
  json["schema"] = "heliograph.bench.frame/1";
  append(json, report.provenance);
  json["scene"] = report.scene;
  json["camera"] = report.camera;
  json["instances"] = report.instances;
  json["size"] = {{"width", report.width}, {"height", report.height}};
  json["bounces"] = report.bounces;
  json["mode"] = name(report.mode);
  json["frames"] = report.frames;
  json["warmup"] = report.warmup;
  json["runs"] = Json::array();
  for (const FrameRun& run : report.runs) json["runs"].push_back(toJson(run));
  if (report.runs.size() == 1) json.update(Json(json["runs"].front()));
  return json;
}

std::string toMarkdown(const FrameReport& report) {
  return origin(report) + "\n" + timeTable(report.runs).markdown() + "\n" + countTable(report.runs).markdown() + "\n" +
         effectTable(report.runs).markdown();
}

}  // namespace helio::bench
