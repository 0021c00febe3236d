#include "bench/frame_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace helio::bench {
namespace {

using testing::HasSubstr;

/// A frame whose path tracing took `ms`, with rays in proportion.
render::FrameStats frame(double ms, render::Primary primary = render::Primary::traced) {
  const bool traced = primary == render::Primary::traced;
  render::FrameStats stats;
  stats.passes = {
      {"tlas", 0.5}, {traced ? "primary_traced" : "primary_raster", 1.0}, {"path_trace", ms}, {"tonemap", 0.25}};
  stats.gpu_ms = 1.75 + ms;
  stats.rays = {traced ? 1000u : 0u, 2000, 3000, 0};
  stats.effects = {{"emissive_triangles", 7, 4096, ms / 10}};
  stats.tlas_instances = 12;
  stats.triangles_drawn = traced ? 0 : 345;
  return stats;
}

render::FrameStats bareFrame(double path_trace_ms, double bare_ms) {
  render::FrameStats stats = frame(path_trace_ms);
  stats.bare_trace_ms = bare_ms;
  return stats;
}

FrameRun tracedRun() {
  const std::vector<render::FrameStats> live{frame(2.0), frame(4.0), frame(3.0)};
  const std::vector<render::FrameStats> bare{bareFrame(3.0, 1.0), bareFrame(10.0, 4.0), bareFrame(6.0, 3.0)};
  return summariseRun(render::Primary::traced, live, bare, {100, 20, 3}, 1500);
}

FrameRun rasterRun() {
  const std::vector<render::FrameStats> live{frame(2.0, render::Primary::raster)};
  const std::vector<render::FrameStats> bare{bareFrame(3.0, 2.0)};
  return summariseRun(render::Primary::raster, live, bare, {}, 1500);
}

FrameReport reportOf(std::vector<FrameRun> runs) {
  FrameReport report;
  report.provenance.device.name = "a device";
  report.provenance.command = "helio-bench frame";
  report.scene = "city";
  report.camera = "forest";
  report.instances = 1234;
  report.width = 50;
  report.height = 30;
  report.runs = std::move(runs);
  return report;
}

TEST(FrameRun, TakesFrameTimesFromLiveFramesOnly) {
  const FrameRun run = tracedRun();
  EXPECT_DOUBLE_EQ(run.frame_ms.median, 4.75);
  EXPECT_DOUBLE_EQ(run.frame_ms.p95, 5.75);
  ASSERT_EQ(run.passes.size(), 4u);
  EXPECT_EQ(run.passes[2].first, "path_trace");
  EXPECT_DOUBLE_EQ(run.passes[2].second.median, 3.0);
  EXPECT_DOUBLE_EQ(run.effects.at(0).pass_ms, 0.3);
}

TEST(FrameRun, ComparesPathsAndBareRaysWithinAFrame) {
  const FrameRun run = tracedRun();
  EXPECT_DOUBLE_EQ(run.path_trace_ms.median, 6.0);
  EXPECT_DOUBLE_EQ(run.bare_trace_ms.median, 3.0);
  EXPECT_DOUBLE_EQ(run.path_trace_over_bare, 2.5);  // of 3, 2.5 and 2, not 6 / 3
}

TEST(FrameRun, CountsRaysByTheTimeOfThePassesThatTraceThem) {
  EXPECT_DOUBLE_EQ(tracedRun().mrays_per_s, 6000.0 / 4.0 / 1e3);  // 6000 rays in (1 + 3) ms
  EXPECT_DOUBLE_EQ(rasterRun().mrays_per_s, 5000.0 / 2.0 / 1e3);  // rasterised hits cost no rays
  EXPECT_DOUBLE_EQ(tracedRun().rays_per_pixel, 4.0);
  EXPECT_EQ(tracedRun().rays.shadow, 3000u);
}

TEST(FrameReport, OneRunIsTheDocumentsOwn) {
  const Json json = toJson(reportOf({tracedRun()}));
  EXPECT_EQ(json["schema"], "heliograph.bench.frame/1");
  EXPECT_EQ(json["size"]["width"], 50);
  ASSERT_EQ(json["runs"].size(), 1u);
  for (const char* key :
       {"passes", "path_trace_ms", "bare_trace_ms", "frame_ms", "path_trace_over_bare", "rays", "memory"}) {
    ASSERT_TRUE(json.contains(key)) << key;
    EXPECT_EQ(json[key], json["runs"][0][key]) << key;
  }
  EXPECT_DOUBLE_EQ(json["passes"]["path_trace"]["median"].get<double>(), 3.0);
  EXPECT_EQ(json["memory"]["total_bytes"], 123);
}

TEST(FrameReport, TwoRunsStandSideBySide) {
  const FrameReport report = reportOf({rasterRun(), tracedRun()});
  const Json json = toJson(report);
  EXPECT_FALSE(json.contains("passes"));
  EXPECT_EQ(json["runs"][0]["primary"], "raster");
  EXPECT_EQ(json["runs"][1]["primary"], "traced");

  const std::string text = toMarkdown(report);
  EXPECT_THAT(text, HasSubstr("- device: a device"));
  EXPECT_THAT(text, HasSubstr("| raster median | raster p95 | traced median | traced p95 |"));
  // A pass that only one run has stands where that run records it.
  const auto at = [&](const char* pass) { return text.find("| - " + std::string(pass) + " "); };
  EXPECT_LT(at("tlas"), at("primary_traced"));
  EXPECT_LT(at("primary_traced"), at("path_trace"));
  EXPECT_LT(at("primary_raster"), at("path_trace"));
  EXPECT_LT(at("path_trace"), text.size());
}

TEST(Report, TablesAreWellFormed) {
  Table table({"name", "n"});
  table.add({"a|b", "1,000"});
  table.add({"c"});
  EXPECT_EQ(table.markdown(),
            "| name |     n |\n"
            "| ---- | ----: |\n"
            "| a\\|b | 1,000 |\n"
            "| c    |       |\n");
}

TEST(Report, CommandsCanBePastedIntoAShell) {
  const char* argv[] = {"helio-bench", "frame", "--device", "NVIDIA H200", "it's", ""};
  EXPECT_EQ(shellCommand(6, argv), R"(helio-bench frame --device 'NVIDIA H200' 'it'\''s' '')");
}

TEST(Report, NumbersAreReadable) {
  EXPECT_EQ(grouped(0), "0");
  EXPECT_EQ(grouped(999), "999");
  EXPECT_EQ(grouped(1'000), "1,000");
  EXPECT_EQ(grouped(1'234'567), "1,234,567");
  EXPECT_EQ(fixed(2.0049, 2), "2.00");
  EXPECT_EQ(megabytes(1'260'000), "1.3");
}

}  // namespace
}  // namespace helio::bench
