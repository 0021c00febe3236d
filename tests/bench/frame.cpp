#include "bench/frame.h"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <iostream>
#include <map>
#include <memory>
#include <utility>

#include "bench/device.h"
#include "bench/files.h"
#include "bench/frame_report.h"
#include "bench/progress.h"
#include "stream/picture.h"

namespace helio::bench {
namespace {

constexpr const char* kNotes = R"(What a frame is:
  As in production, every frame brings the acceleration structures up to date: the smallest instance that users may
  move goes 1 mm up and down in turn, by an edit, so that the passes instances, assemble and tlas are recorded each
  time. Nothing is accumulated; the exposure is automatic.
  frame_ms is the sum of a frame's passes by GPU timestamps. bare_trace_ms is the time that the same rays of the same
  frame take with empty shading; logging them costs time and memory, so it is done in frames of its own, which alternate
  with the measured ones. path_trace_ms and path_trace_over_bare are those frames' too.

Examples:
  helio-bench frame --instances 1000 --size 320x180
  helio-bench frame --instances 100000 --size 1920x1080 --primary traced --frames 200 --device NVIDIA --json
  helio-bench frame --scene model.glb --mode reference --out model.png)";

/// One way to find primary hits, and its frames so far.
struct Series {
  render::ViewSettings settings;
  render::ViewHandle view = 0;
  render::MemoryUse memory;
  std::vector<render::FrameStats> live, bare;
};

class Measurement {
 public:
  Measurement(const FrameOptions& options, render::Renderer& renderer, Stage& stage)
      : options_(options), renderer_(renderer), stage_(stage) {
    for (const render::Primary primary : options.primaries) {
      Series series;
      series.settings = options.view;
      series.settings.primary = primary;
      series_.push_back(std::move(series));
    }
  }

  Result<void> run() {
    const Result<render::WorldHandle> world = renderer_.addWorld(stage_.scene());
    if (!world) return world.error();
    world_ = *world;
    for (Series& series : series_)
      if (auto measured = measureMemory(series); !measured) return measured;
    if (auto added = addViews(); !added) return added;
    if (auto warmed = rounds("warming up", options_.warmup); !warmed) return warmed;
    for (Series& series : series_) {
      series.live.clear();
      series.bare.clear();
    }
    return rounds("measuring", options_.frames);
  }

  std::vector<FrameRun> runs() const {
    const uint64_t pixels = uint64_t{options_.view.width} * options_.view.height;
    std::vector<FrameRun> runs;
    for (const Series& s : series_) runs.push_back(summariseRun(s.settings.primary, s.live, s.bare, s.memory, pixels));
    return runs;
  }

  const render::Pixels& picture() const { return *picture_; }

 private:
  /// Memory counts for the device as a whole, so each kind is looked at while its view is the only one.
  Result<void> measureMemory(Series& series) {
    if (auto added = addView(series); !added) return added;
    for (int tick = 0; tick < 2; ++tick) {  // the first one fills the tables
      const Result<render::Frame> frame = render(series, false);
      if (!frame) return frame.error();
      series.memory = frame->stats.memory;
    }
    renderer_.removeView(series.view);
    return {};
  }

  Result<void> addViews() {
    for (Series& series : series_)
      if (auto added = addView(series); !added) return added;
    return {};
  }

  Result<void> addView(Series& series) {
    const Result<render::ViewHandle> view = renderer_.addView(world_);
    if (!view) return view.error();
    series.view = *view;
    return {};
  }

  /// Rounds of a live frame and a bare one of each series: whatever slows the machine down meets all of them alike.
  Result<void> rounds(const char* label, uint32_t count) {
    Progress progress(std::string(label) + ", " + std::to_string(count) + " rounds", count);
    for (uint32_t i = 0; i < count; ++i, progress.step())
      for (Series& series : series_) {
        Result<render::Frame> live = render(series, false);
        if (!live) return live.error();
        const Result<render::Frame> bare = render(series, true);
        if (!bare) return bare.error();
        series.live.push_back(live->stats);
        series.bare.push_back(bare->stats);
        picture_ = std::move(live->pixels);
      }
    return {};
  }

  Result<render::Frame> render(const Series& series, bool bare_trace) {
    const Result<world::ChangeSet> changes = stage_.advance();
    if (!changes) return changes.error();
    render::ViewRequest request{series.view, stage_.camera().camera, series.settings};
    request.settings.measure_bare_trace = bare_trace;
    Result<std::vector<render::Frame>> frames = renderer_.tick(world_, *changes, {&request, 1});
    if (!frames) return frames.error();
    return std::move(frames->front());
  }

  const FrameOptions& options_;
  render::Renderer& renderer_;
  Stage& stage_;
  render::WorldHandle world_ = 0;
  std::vector<Series> series_;
  std::shared_ptr<const render::Pixels> picture_;
};

Result<void> writePicture(const render::Pixels& pixels, const std::string& path) {
  const Result<std::string> png = stream::encodePng(pixels);
  return png ? writeFile(path, *png) : png.error();
}

Result<void> measureFrames(const FrameOptions& options, const std::string& command_line) {
  auto renderer = render::makeRenderer(options.renderer);
  if (!renderer) return renderer.error();
  FrameReport report;
  report.provenance = provenance((*renderer)->device(), command_line);
  Result<Stage> stage = [&] {
    const Progress progress("making the scene");
    return Stage::open(options.stage);
  }();
  if (!stage) return stage.error();

  Measurement measurement(options, **renderer, *stage);
  if (auto measured = measurement.run(); !measured) return measured;

  report.scene = options.stage.scene;
  report.camera = stage->camera().name;
  report.instances = stage->instances();
  report.width = options.view.width;
  report.height = options.view.height;
  report.bounces = options.view.bounces;
  report.mode = options.view.mode;
  report.frames = options.frames;
  report.warmup = options.warmup;
  report.runs = measurement.runs();
  std::cout << (options.json ? toJson(report).dump(2) + "\n" : toMarkdown(report)) << std::flush;
  if (!std::cout) return Error{ErrorKind::internal, "cannot write the result to standard output", {}, {}, {}};
  return options.picture.empty() ? Result<void>() : writePicture(measurement.picture(), options.picture);
}

/// What must hold between flags. Throws CLI::ValidationError.
void finish(FrameOptions& options, const std::string& primary) {
  using enum render::Primary;
  const bool reference = options.view.mode == render::Mode::reference;
  if (reference && (primary == "raster" || primary == "both"))
    throw CLI::ValidationError("--primary", "reference traces its primary rays: leave out --primary " + primary);
  if (reference || primary == "traced") options.primaries = {traced};
  else if (primary == "raster") options.primaries = {raster};
  else options.primaries = {raster, traced};
  options.view.accumulate = false;
  if (auto valid = check(options.stage); !valid) throw CLI::ValidationError("--scene", valid.error().message);
  if (auto valid = render::check(options.view); !valid) throw CLI::ValidationError("frame", valid.error().message);
}

}  // namespace

void addFrameCommand(CLI::App& app, const std::string& command_line, Action& chosen) {
  const auto options = std::make_shared<FrameOptions>();
  const auto primary = std::make_shared<std::string>();
  CLI::App& command =
      *app.add_subcommand("frame", "times frames by pass, counts their rays, and compares with bare tracing");
  command.footer(kNotes);
  addStageOptions(command, options->stage);
  addSizeOption(command, options->view.width, options->view.height);
  command.add_option("--bounces", options->view.bounces, "of a path, 0 to 32")->capture_default_str();
  command
      .add_option("--path-launches", options->view.path_launches,
                  "launches of a frame's paths, at most; default: what suits the picture's size")
      ->option_text("UINT");
  command.add_option("--frames", options->frames, "measured of each kind, 1 to 1,000,000")
      ->capture_default_str()
      ->check(CLI::Range(1, 1'000'000).description(""));
  command.add_option("--warmup", options->warmup, "rounds before the first measured one, 0 to 1,000,000")
      ->capture_default_str()
      ->check(CLI::Range(0, 1'000'000).description(""));
  const std::map<std::string, render::Mode> modes{{"hybrid", render::Mode::hybrid},
                                                  {"reference", render::Mode::reference}};
  command.add_option("--mode", options->view.mode, "hybrid or reference; default: hybrid")
      ->transform(CLI::CheckedTransformer(modes))
      ->option_text("MODE");
  command
      .add_option("--primary", *primary,
                  "how primary hits are found: raster, traced, or both in turn; default: both in mode hybrid, traced "
                  "in mode reference")
      ->check(CLI::IsMember({"raster", "traced", "both"}))
      ->option_text("KIND");
  addDeviceOptions(command, options->renderer);
  command.add_flag("--json", options->json, "one JSON document, schema heliograph.bench.frame/1");
  command.add_option("--out", options->picture, "PNG file for the last picture measured");
  command.callback([&chosen, options, primary, command_line] {
    finish(*options, *primary);
    chosen = [options, command_line] { return measureFrames(*options, command_line); };
  });
}

}  // namespace helio::bench
