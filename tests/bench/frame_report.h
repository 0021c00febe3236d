// The figures of `helio-bench frame`, as JSON and as Markdown.
#pragma once

#include <span>
#include <string>
#include <utility>
#include <vector>

#include "bench/report.h"
#include "bench/statistics.h"
#include "render/renderer.h"

namespace helio::bench {

/// Figures of one way to find primary hits.
struct FrameRun {
  render::Primary primary = render::Primary::raster;
  Summary frame_ms;                                     ///< sum of a frame's passes
  std::vector<std::pair<std::string, Summary>> passes;  ///< milliseconds, in the order of the frame
  Summary path_trace_ms;                                ///< in the frames that were traced bare as well
  Summary bare_trace_ms;                                ///< the same rays through empty shading
  double path_trace_over_bare = 0.0;                    ///< median of the quotients of each such frame
  render::Rays rays;                                    ///< a frame's, medians by kind
  double rays_per_pixel = 0.0;                          ///< median of all kinds together
  double mrays_per_s =
      0.0;  ///< median of a frame's rays by the time of the passes that trace them (path_trace, primary_traced)
  uint32_t tlas_instances = 0;
  uint64_t triangles_drawn = 0;  ///< rasterised
  uint64_t nonfinite = 0;        ///< samples dropped in all frames; anything but 0 is a fault
  render::MemoryUse memory;
  std::vector<render::EffectCost> effects;  ///< those present; pass_ms is a median
};

/// `live`: frames as they are in production; `bare`: frames that were traced bare too. Neither may be empty.
FrameRun summariseRun(render::Primary primary, std::span<const render::FrameStats> live,
                      std::span<const render::FrameStats> bare, const render::MemoryUse& memory, uint64_t pixels);

struct FrameReport {
  Provenance provenance;
  std::string scene;
  std::string camera;
  uint64_t instances = 0;
  uint32_t width = 0;
  uint32_t height = 0;
  uint32_t bounces = 0;
  render::Mode mode = render::Mode::hybrid;
  uint32_t frames = 0;
  uint32_t warmup = 0;
  std::vector<FrameRun> runs;
};

const char* name(render::Mode mode);
const char* name(render::Primary primary);

/// Schema heliograph.bench.frame/1 (README.md); with one run its fields are the document's own as well.
Json toJson(const FrameReport& report);
std::string toMarkdown(const FrameReport& report);

}  // namespace helio::bench
