#include <spdlog/fmt/fmt.h>
#include <algorithm>

#include "bench/culling.h"

namespace helio::bench {
namespace {

Json toJson(const Summary& summary) { return {{"median", summary.median}, {"p95", summary.p95}}; }
Json toJson(const ImageError& error) { return {{"relative_mse", error.relative_mse}, {"ssim", error.ssim}}; }

Json toJson(const CullingRun& run) {
  const render::AccelerationUse& memory = run.memory;
  return {{"tlas_instances", toJson(run.tlas_instances)},
          {"own_blas_count", toJson(run.own_blas_count)},
          {"own_blas_in_view", toJson(run.own_blas_in_view)},
          {"rt_memory_bytes",
           {{"shared_blas", memory.shared_blas_bytes},
            {"own_blas", memory.own_blas_bytes},
            {"own_vertices", memory.own_vertex_bytes},
            {"tlas", memory.tlas_bytes},
            {"scratch", memory.scratch_bytes},
            {"culling", memory.culling_bytes},
            {"total", memory.total()}}},
          {"compaction_saved_bytes", memory.compaction_saved_bytes},
          {"working_set_bytes", run.working_set_bytes},
          {"cpu_bytes", run.cpu_bytes},
          {"blas_triangles", toJson(run.blas_triangles)},
          {"shadow_triangles", toJson(run.shadow_triangles)},
          {"skin_ms", toJson(run.skin_ms)},
          {"blas_ms", toJson(run.blas_ms)},
          {"tlas_ms", toJson(run.tlas_ms)},
          {"assemble_ms", toJson(run.assemble_ms)},
          {"feedback_ms", toJson(run.feedback_ms)},
          {"state_changes", toJson(run.state_changes)},
          {"cycles", run.cycles},
          {"box_hits", run.states ? run.states->box_hits : 0},
          {"shared_blases", memory.shared_blases},
          {"shared_blases_waiting", memory.shared_blases_waiting},
          {"path_trace_ms", toJson(run.path_trace_ms)},
          {"shadow_ms", toJson(run.shadow_ms)},
          {"primary_ms", toJson(run.primary_ms)},
          {"frame_ms", toJson(run.frame_ms)},
          {"span_ms", toJson(run.span_ms)},
          {"image_error", {{"composite", toJson(run.composite)}, {"indirect", toJson(run.indirect)}}}};
}

std::string ms(const Summary& s) { return fixed(s.median, 2) + " (" + fixed(s.p95, 2) + ")"; }
std::string count(const Summary& s) { return grouped(static_cast<uint64_t>(s.median + 0.5)); }

/// What a bar shows of a run.
struct Quantity {
  const char* label;
  double (*value)(const CullingRun&);
};

constexpr Quantity kTimes[] = {{"skin", [](const CullingRun& r) { return r.skin_ms.median; }},
                               {"blas", [](const CullingRun& r) { return r.blas_ms.median; }},
                               {"assemble", [](const CullingRun& r) { return r.assemble_ms.median; }},
                               {"feedback", [](const CullingRun& r) { return r.feedback_ms.median; }},
                               {"tlas", [](const CullingRun& r) { return r.tlas_ms.median; }},
                               {"primary", [](const CullingRun& r) { return r.primary_ms.median; }},
                               {"path trace", [](const CullingRun& r) { return r.path_trace_ms.median; }},
                               {"frame", [](const CullingRun& r) { return r.frame_ms.median; }}};
constexpr Quantity kMemory[] = {
    {"shared BLAS", [](const CullingRun& r) { return double(r.memory.shared_blas_bytes) / 1e6; }},
    {"own BLAS", [](const CullingRun& r) { return double(r.memory.own_blas_bytes) / 1e6; }},
    {"vertices", [](const CullingRun& r) { return double(r.memory.own_vertex_bytes) / 1e6; }},
    {"TLAS", [](const CullingRun& r) { return double(r.memory.tlas_bytes) / 1e6; }},
    {"scratch", [](const CullingRun& r) { return double(r.memory.scratch_bytes) / 1e6; }},
    {"total", [](const CullingRun& r) { return double(r.memory.total()) / 1e6; }}};
constexpr const char* kColors[] = {"#35618f", "#c8752d", "#5b8c4a", "#8a4f7d"};

template <size_t N>
std::string bars(const std::vector<CullingRun>& runs, const Quantity (&quantities)[N], const std::string& title,
                 double top) {
  constexpr double kLeft = 110.0, kWidth = 560.0, kBar = 13.0;
  double most = 1e-9;
  for (const Quantity& q : quantities)
    for (const CullingRun& run : runs) most = std::max(most, q.value(run));
  std::string svg = fmt::format("<text x='10' y='{:.0f}' font-weight='bold'>{}</text>\n", top, title);
  double y = top + 12.0;
  for (const Quantity& q : quantities) {
    svg += fmt::format("<text x='{}' y='{:.1f}' text-anchor='end'>{}</text>\n", kLeft - 8.0, y + kBar * 0.8, q.label);
    for (size_t r = 0; r < runs.size(); ++r, y += kBar) {
      const double value = q.value(runs[r]);
      svg += fmt::format(
          "<rect x='{}' y='{:.1f}' width='{:.2f}' height='{}' fill='{}'/><text x='{:.1f}' y='{:.1f}'>{:.2f}</text>\n",
          kLeft, y, kWidth * value / most, kBar - 2.0, kColors[r % std::size(kColors)],
          kLeft + kWidth * value / most + 4.0, y + kBar * 0.75, value);
    }
    y += 6.0;
  }
  return svg;
}

}  // namespace

Json toJson(const CullingReport& report) {
  Json json = {{"schema", "heliograph.bench.culling/1"}};
  append(json, report.provenance);
  json["camera"] = report.camera;
  json["instances"] = report.instances;
  json["animated"] = report.animated;
  json["width"] = report.width;
  json["height"] = report.height;
  json["frames"] = report.frames;
  json["warmup"] = report.warmup;
  json["samples"] = report.samples;
  json["strategies"] = Json::object();
  for (const CullingRun& run : report.runs) json["strategies"][run.strategy] = toJson(run);
  return json;
}

std::string toMarkdown(const CullingReport& report) {
  std::string text = fmt::format("# Culling: {}, {} instances, {} of them animated, {}x{}\n\n", report.camera,
                                 grouped(report.instances), grouped(report.animated), report.width, report.height);
  text += markdown(report.provenance);
  text += fmt::format("- {} frames after {}; median (95th percentile); errors against full, {} samples a pixel\n\n",
                      report.frames, report.warmup, report.samples);
  std::vector<std::string> header{""};
  for (const CullingRun& run : report.runs) header.push_back(run.strategy);
  Table table(header);
  const auto row = [&](const char* label, auto&& cell) {
    std::vector<std::string> cells{label};
    for (const CullingRun& run : report.runs) cells.push_back(cell(run));
    table.add(std::move(cells));
  };
  row("TLAS instances", [](const CullingRun& r) { return count(r.tlas_instances); });
  row("own BLASes", [](const CullingRun& r) { return count(r.own_blas_count); });
  row("own BLASes in view", [](const CullingRun& r) { return count(r.own_blas_in_view); });
  const auto state = [&](const char* label, uint32_t accel::LipacFigures::*figure) {
    row(label, [figure](const CullingRun& r) { return r.states ? grouped(*r.states.*figure) : std::string("-"); });
  };
  state("instances: active", &accel::LipacFigures::active);
  state("instances: omitted", &accel::LipacFigures::omitted);
  state("instances: requested", &accel::LipacFigures::requested);
  state("instances: inactive", &accel::LipacFigures::inactive);
  state("hitboxes in the TLAS", &accel::LipacFigures::boxes);
  row("state changes a tick", [](const CullingRun& r) { return r.states ? count(r.state_changes) : "-"; });
  row("hits of hitboxes in a tick", [](const CullingRun& r) { return r.states ? grouped(r.states->box_hits) : "-"; });
  row("cycles", [](const CullingRun& r) { return r.states ? grouped(r.cycles) : "-"; });
  row("BLAS triangles a tick", [](const CullingRun& r) { return count(r.blas_triangles); });
  row("triangles of the shadow map", [](const CullingRun& r) { return count(r.shadow_triangles); });
  row("shared BLASes", [](const CullingRun& r) { return grouped(r.memory.shared_blases); });
  row("memory: shared BLASes, MB", [](const CullingRun& r) { return megabytes(r.memory.shared_blas_bytes); });
  row("saved by compacting them, MB", [](const CullingRun& r) { return megabytes(r.memory.compaction_saved_bytes); });
  row("memory: own BLASes, MB", [](const CullingRun& r) { return megabytes(r.memory.own_blas_bytes); });
  row("memory: own vertices, MB", [](const CullingRun& r) { return megabytes(r.memory.own_vertex_bytes); });
  row("memory: TLAS, MB", [](const CullingRun& r) { return megabytes(r.memory.tlas_bytes); });
  row("memory: scratch, MB", [](const CullingRun& r) { return megabytes(r.memory.scratch_bytes); });
  row("memory: counters and states, MB", [](const CullingRun& r) { return megabytes(r.memory.culling_bytes); });
  row("memory: total, MB", [](const CullingRun& r) { return megabytes(r.memory.total()); });
  row("memory: working set, MB", [](const CullingRun& r) { return megabytes(r.working_set_bytes); });
  row("memory: CPU, MB", [](const CullingRun& r) { return megabytes(r.cpu_bytes); });
  row("poses and skinning, ms", [](const CullingRun& r) { return ms(r.skin_ms); });
  row("BLAS, ms", [](const CullingRun& r) { return ms(r.blas_ms); });
  row("assemble, ms", [](const CullingRun& r) { return ms(r.assemble_ms); });
  row("feedback, ms", [](const CullingRun& r) { return ms(r.feedback_ms); });
  row("TLAS, ms", [](const CullingRun& r) { return ms(r.tlas_ms); });
  row("primary hits, ms", [](const CullingRun& r) { return ms(r.primary_ms); });
  row("path trace, ms", [](const CullingRun& r) { return ms(r.path_trace_ms); });
  row("shadow map, ms", [](const CullingRun& r) { return ms(r.shadow_ms); });
  row("frame, ms", [](const CullingRun& r) { return ms(r.frame_ms); });
  row("frame, from beginning to end, ms", [](const CullingRun& r) { return ms(r.span_ms); });
  row("relative MSE", [](const CullingRun& r) { return fmt::format("{:.2e}", r.composite.relative_mse); });
  row("SSIM", [](const CullingRun& r) { return fixed(r.composite.ssim, 5); });
  row("relative MSE, indirect", [](const CullingRun& r) { return fmt::format("{:.2e}", r.indirect.relative_mse); });
  row("SSIM, indirect", [](const CullingRun& r) { return fixed(r.indirect.ssim, 5); });
  return text + table.markdown();
}

std::string toSvg(const CullingReport& report) {
  std::string svg =
      "<svg xmlns='http://www.w3.org/2000/svg' width='760' height='560' font-family='sans-serif' font-size='11'>\n"
      "<rect width='760' height='560' fill='white'/>\n";
  double x = 110.0;
  for (size_t r = 0; r < report.runs.size(); ++r, x += 140.0)
    svg += fmt::format("<rect x='{0}' y='10' width='10' height='10' fill='{1}'/><text x='{2}' y='19'>{3}</text>\n", x,
                       kColors[r % std::size(kColors)], x + 14.0, report.runs[r].strategy);
  const double height =
      44.0 + static_cast<double>(std::size(kTimes)) * (13.0 * static_cast<double>(report.runs.size()) + 6.0);
  svg += bars(report.runs, kTimes, "ms a tick, median: " + report.camera, 40.0);
  svg += bars(report.runs, kMemory, "MB for ray tracing", 40.0 + height);
  return svg + "</svg>\n";
}

}  // namespace helio::bench
