// `helio-bench culling`: what the culling strategies cost and what they do to the picture, on one scene in one run.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bench/command.h"
#include "bench/report.h"
#include "bench/stage.h"
#include "bench/statistics.h"
#include "render/renderer.h"

namespace helio::bench {

struct CullingOptions {
  StageOptions stage;
  uint32_t width = 320, height = 180;
  uint32_t frames = 40;
  uint32_t warmup = 10;
  uint32_t samples = 256;  ///< averaged for the image error
  std::vector<std::string> strategies = {"full", "frustum_radius"};
  std::string pictures;               ///< a folder for each strategy's picture and its error; empty: none
  std::vector<std::string> settings;  ///< of the views: NAME=VALUE
  bool builds_aside = false;          ///< on a queue of their own, where the device has one
  uint32_t counted_paths = accel::LipacSettings{}.counted_paths;
  uint32_t smoothing = accel::LipacSettings{}.smoothing;
  bool one_call_a_blas = false;  ///< BLASes of instances' own are built one by one
  std::string device;
  std::string plot;  ///< an SVG file; empty: none
  bool json = false;
};

/// Against `full`, at equal samples, in linear radiance and on the tonemapped picture.
struct ImageError {
  double relative_mse = 0.0;
  double ssim = 1.0;
};

/// Times and counts are of ticks in which everything moves; memory and errors of one in which everything stands.
struct CullingRun {
  std::string strategy;
  Summary tlas_instances, own_blas_count, own_blas_in_view, blas_triangles, shadow_triangles;
  Summary skin_ms;  ///< poses and deformed vertices
  Summary blas_ms, tlas_ms, assemble_ms, feedback_ms, path_trace_ms, shadow_ms, primary_ms, frame_ms, span_ms;
  Summary state_changes;  ///< instances a tick; 0 where nothing has states
  uint64_t cycles = 0;    ///< hitboxes, and instances with a BLAS of their own, that went back in all measured ticks
  std::optional<accel::LipacFigures> states;  ///< of the last measured tick
  render::AccelerationUse memory;
  uint64_t working_set_bytes = 0, cpu_bytes = 0;  ///< of the world (render::MemoryUse)
  ImageError composite, indirect;
};

struct CullingReport {
  Provenance provenance;
  std::string camera;
  uint64_t instances = 0;
  uint32_t animated = 0, width = 0, height = 0, frames = 0, warmup = 0, samples = 0;
  std::vector<CullingRun> runs;
};

Json toJson(const CullingReport& report);
std::string toMarkdown(const CullingReport& report);
/// Bars a strategy for times and memory.
std::string toSvg(const CullingReport& report);

/// Adds the subcommand, which becomes `chosen` when it is the one on the command line.
void addCullingCommand(CLI::App& app, const std::string& command_line, Action& chosen);

}  // namespace helio::bench
