#include "bench/jump.h"

#include <spdlog/fmt/fmt.h>
#include <algorithm>
#include <chrono>

#include "bench/culled_world.h"
#include "bench/plot.h"
#include "bench/progress.h"
#include "bench/report.h"
#include "bench/stage.h"
#include "bench/statistics.h"

namespace helio::bench {
namespace {

constexpr const char* kNotes = R"(What is measured:
  A camera that looks at the sky until nothing moves into or out of the TLAS, then jumps to --camera, with light path
  guided culling, in a world where everything moves. --settle ticks later the hits of every instance are read. A
  frame's share is that of those hits that belong to instances which were in the frame's TLAS; what is too large to be
  culled counts on neither side. The error is the frame's relative mean square error against a world without culling
  that drew the same random numbers. Times are of the same ticks once more, one right behind the other and each world by
  itself: a GPU that waits while pictures are compared slows its clock. Then all of it for a new world whose first tick is
  that of its first viewer.

Examples:
  helio-bench jump --camera tilted_city --instances 2000 --animated 500 --frames 12 --settle 40
  helio-bench jump --camera tilted_city --instances 100000 --animated 6000 --size 1920x1080 --device NVIDIA --json)";

constexpr double kComplete = 0.999;  // of the settled hits

struct JumpOptions {
  CullingStage common;
  std::string mitigation = "both";
  std::string to = "view";
  uint32_t empty = 60;   // ticks of the empty view
  uint32_t frames = 60;  // behind the jump
  uint32_t settle = 90;  // ticks behind those, before hits are read
  std::string pictures;  // a folder
};

struct JumpFrame {
  double share = 0.0;  // of the settled hits
  double relative_mse = 0.0;
  double gpu_ms = 0.0, wall_ms = 0.0, full_gpu_ms = 0.0;
  uint32_t active = 0, opened = 0, shown = 0, served = 0, built = 0, entries = 0;
  uint64_t cpu_visits = 0;
};

struct Arrival {
  std::string name;  // jump, attach
  bool mitigation = false;
  double load_ms = 0.0;  // of a new world, until its first tick
  std::vector<JumpFrame> frames;
  double settled_ms = 0.0;  // of a frame
  uint32_t carriers = 0;    // instances that have settled hits

  /// 0: never.
  size_t complete() const {
    const auto found = std::find_if(frames.begin(), frames.end(), [](const auto& f) { return f.share >= kComplete; });
    return found == frames.end() ? 0 : static_cast<size_t>(found - frames.begin()) + 1;
  }
  double worstMs() const {
    return std::max_element(frames.begin(), frames.end(), [](auto& a, auto& b) { return a.gpu_ms < b.gpu_ms; })->gpu_ms;
  }
};

struct JumpReport {
  Provenance provenance;
  std::string camera, to;
  uint64_t instances = 0;
  uint32_t width = 0, height = 0;
  std::vector<Arrival> arrivals;
};

class Arriving {
 public:
  Arriving(const JumpOptions& options, const OpenStage& stage, const scene::ScenePtr& scene,
           const scene::Camera& target, const render::ViewSettings& settings)
      : options_(options), stage_(stage), scene_(scene), target_(target), settings_(settings) {}

  /// `jump`: from an empty view; else a new world is looked at.
  Result<Arrival> measure(bool mitigation, bool jump) {
    Arrival arrival{jump ? "jump" : "attach", mitigation, 0.0, {}, 0.0, 0};
    render::CullingSettings culling;
    culling.lipac.mitigation = mitigation;
    const auto full_times = times(render::Culling::full, {}, jump, 0);
    if (!full_times) return full_times.error();
    const auto guided_times = times(render::Culling::lipac, culling, jump, options_.settle);
    if (!guided_times) return guided_times.error();
    arrival.load_ms = guided_times->load_ms;
    arrival.settled_ms = guided_times->settled_ms;

    const scene::Environment& light = stage_.camera->environment;
    auto full = CulledWorld::open(*stage_.renderer, scene_, light, render::Culling::full);
    if (!full) return full.error();
    auto guided = CulledWorld::open(*stage_.renderer, scene_, light, render::Culling::lipac, culling);
    if (!guided) return guided.error();
    const uint32_t empty = jump ? options_.empty : 0;
    Progress progress(fmt::format("{}, mitigation {}", arrival.name, mitigation ? "on" : "off"),
                      empty + options_.frames + options_.settle);
    for (CulledWorld* world : {full->get(), guided->get()})
      if (auto looked = lookAtSky(*world, empty); !looked) return looked.error();

    std::vector<std::vector<bool>> traced;
    for (uint32_t i = 0; i < options_.frames; ++i, progress.step()) {
      auto truth = (*full)->tick(target_, settings_);
      if (!truth) return truth.error();
      auto frame = (*guided)->tick(target_, settings_);
      if (!frame) return frame.error();
      const auto instances = (*guided)->instances();
      if (!instances) return instances.error();
      traced.emplace_back();
      for (const render::CulledInstance& instance : *instances) traced.back().push_back(instance.traced);
      const accel::LipacFigures& f = *frame->stats.lipac;
      JumpFrame shown;
      shown.gpu_ms = guided_times->gpu_ms[i];
      shown.wall_ms = guided_times->wall_ms[i];
      shown.full_gpu_ms = full_times->gpu_ms[i];
      shown.active = f.active;
      shown.opened = f.opened;
      shown.shown = f.shown;
      shown.served = f.served;
      shown.built = frame->stats.acceleration.blases_built;
      shown.entries = f.entries;
      shown.cpu_visits = f.cpu_visits;
      const Image image = imageOf(std::move(*frame)), expected = imageOf(std::move(*truth));
      shown.relative_mse = relativeMse(image, expected);
      if (!options_.pictures.empty()) {
        const std::string name = fmt::format("{}_{}_{:02}", arrival.name, mitigation ? "on" : "off", i);
        if (auto written = writePictures(options_.pictures, name, image, expected); !written) return written.error();
      }
      arrival.frames.push_back(shown);
    }
    for (uint32_t i = 0; i < options_.settle; ++i, progress.step())
      if (auto frame = (*guided)->tick(target_, settings_); !frame) return frame.error();
    const auto settled = (*guided)->instances();
    if (!settled) return settled.error();
    double all = 0.0;
    for (const render::CulledInstance& instance : *settled)
      if (instance.traced && !instance.always && instance.hits > 0.0) {
        all += instance.hits;
        ++arrival.carriers;
      }
    for (size_t i = 0; i < arrival.frames.size(); ++i) {
      double held = 0.0;
      for (size_t slot = 0; slot < settled->size(); ++slot) {
        const render::CulledInstance& instance = (*settled)[slot];
        if (instance.traced && !instance.always && traced[i][slot]) held += instance.hits;
      }
      arrival.frames[i].share = all > 0.0 ? held / all : 1.0;
    }
    return arrival;
  }

 private:
  struct Times {
    std::vector<double> gpu_ms, wall_ms;  // by frame
    double load_ms = 0.0;                 // of a new world, until its first tick
    double settled_ms = 0.0;              // of a frame in the second half of the ticks behind
  };
  Result<void> lookAtSky(CulledWorld& world, uint32_t ticks) const {
    scene::Camera sky = target_;
    sky.forward = {0.0f, 1.0f, 0.0f};
    sky.up = {0.0f, 0.0f, 1.0f};
    for (uint32_t i = 0; i < ticks; ++i)
      if (auto frame = world.tick(sky, settings_); !frame) return frame.error();
    return {};
  }
  /// Of a world of its own, whose ticks follow each other at once.
  Result<Times> times(render::Culling kind, const render::CullingSettings& culling, bool jump, uint32_t settle) const {
    Times times;
    const auto start = std::chrono::steady_clock::now();
    auto world = CulledWorld::open(*stage_.renderer, scene_, stage_.camera->environment, kind, culling);
    if (!world) return world.error();
    times.load_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    if (auto looked = lookAtSky(**world, jump ? options_.empty : 0); !looked) return looked.error();
    std::vector<double> settled_ms;
    for (uint32_t i = 0; i < options_.frames + settle; ++i) {
      auto frame = (*world)->tick(target_, settings_);
      if (!frame) return frame.error();
      if (i < options_.frames) {
        times.gpu_ms.push_back(frame->stats.gpu_ms);
        times.wall_ms.push_back((*world)->wallMs());
      } else if (i >= options_.frames + settle / 2) {
        settled_ms.push_back(frame->stats.gpu_ms);
      }
    }
    if (!settled_ms.empty()) times.settled_ms = median(settled_ms);
    return times;
  }

  const JumpOptions& options_;
  const OpenStage& stage_;
  const scene::ScenePtr& scene_;
  const scene::Camera& target_;
  const render::ViewSettings& settings_;
};

std::string label(const Arrival& arrival) {
  return arrival.name + (arrival.mitigation ? ", mitigation on" : ", mitigation off");
}

Json toJson(const JumpReport& report) {
  Json json = {{"schema", "heliograph.bench.jump/1"}};
  append(json, report.provenance);
  json["camera"] = report.camera;
  json["to"] = report.to;
  json["instances"] = report.instances;
  json["width"] = report.width;
  json["height"] = report.height;
  json["arrivals"] = Json::array();
  for (const Arrival& arrival : report.arrivals) {
    Json frames = Json::array();
    for (const JumpFrame& f : arrival.frames)
      frames.push_back({{"share", f.share},
                        {"relative_mse", f.relative_mse},
                        {"gpu_ms", f.gpu_ms},
                        {"wall_ms", f.wall_ms},
                        {"full_gpu_ms", f.full_gpu_ms},
                        {"active", f.active},
                        {"opened_hitboxes", f.opened},
                        {"shown", f.shown},
                        {"served", f.served},
                        {"blases_built", f.built},
                        {"tlas_entries", f.entries},
                        {"cpu_visits", f.cpu_visits}});
    json["arrivals"].push_back({{"name", arrival.name},
                                {"mitigation", arrival.mitigation},
                                {"load_ms", arrival.load_ms},
                                {"carriers", arrival.carriers},
                                {"complete_frame", arrival.complete()},
                                {"settled_ms", arrival.settled_ms},
                                {"worst_ms", arrival.worstMs()},
                                {"frames", frames}});
  }
  return json;
}

std::string toMarkdown(const JumpReport& report) {
  std::string text =
      fmt::format("# Jump: {}{}, {} instances, {}x{}\n\n", report.camera, report.to == "mirror" ? " in a mirror" : "",
                  grouped(report.instances), report.width, report.height);
  text += markdown(report.provenance) + "\n";
  Table summary({"", "first share", "complete by frame", "first frame, ms", "worst frame, ms", "settled, ms",
                 "worst / settled", "first error", "settled error", "load, ms"});
  for (const Arrival& a : report.arrivals)
    summary.add({label(a), fixed(a.frames.front().share, 4), a.complete() ? std::to_string(a.complete()) : "-",
                 fixed(a.frames.front().gpu_ms, 2), fixed(a.worstMs(), 2), fixed(a.settled_ms, 2),
                 fixed(a.worstMs() / a.settled_ms, 2), fmt::format("{:.2e}", a.frames.front().relative_mse),
                 fmt::format("{:.2e}", a.frames.back().relative_mse), fixed(a.load_ms, 1)});
  text += summary.markdown() + "\n";
  for (const Arrival& a : report.arrivals) {
    text += fmt::format("## {}: {} instances carry the settled hits\n\n", label(a), grouped(a.carriers));
    Table table({"frame", "share", "relative MSE", "gpu, ms", "wall, ms", "full, ms", "active", "hitboxes opened",
                 "shown", "served", "BLASes built", "TLAS entries", "CPU visits"});
    for (size_t i = 0; i < a.frames.size(); ++i) {
      if (i >= 8 && (i + 1) % 8 != 0) continue;
      const JumpFrame& f = a.frames[i];
      table.add({std::to_string(i + 1), fixed(f.share, 4), fmt::format("{:.2e}", f.relative_mse), fixed(f.gpu_ms, 2),
                 fixed(f.wall_ms, 2), fixed(f.full_gpu_ms, 2), grouped(f.active), grouped(f.opened), grouped(f.shown),
                 grouped(f.served), grouped(f.built), grouped(f.entries), grouped(f.cpu_visits)});
    }
    text += table.markdown() + "\n";
  }
  return text;
}

std::string toSvg(const JumpReport& report) {
  std::vector<Chart> charts{{"Share of the settled hits that the TLAS holds", "frame", {}},
                            {"Relative MSE against no culling", "frame", {}},
                            {"GPU, ms", "frame", {}}};
  for (const Arrival& a : report.arrivals) {
    Series share{label(a), {}}, error{label(a), {}}, time{label(a), {}};
    for (size_t i = 0; i < a.frames.size(); ++i) {
      const auto frame = static_cast<double>(i + 1);
      share.points.emplace_back(frame, a.frames[i].share);
      error.points.emplace_back(frame, a.frames[i].relative_mse);
      time.points.emplace_back(frame, a.frames[i].gpu_ms);
    }
    charts[0].series.push_back(std::move(share));
    charts[1].series.push_back(std::move(error));
    charts[2].series.push_back(std::move(time));
  }
  return toSvg(charts);
}

Result<void> measureJump(const JumpOptions& options, const std::string& command_line) {
  const auto settings = viewSettings(options.common);
  if (!settings) return settings.error();
  const auto stage = openStage(options.common);
  if (!stage) return stage.error();
  JumpReport report;
  report.provenance = provenance(stage->renderer->device(), command_line);
  report.camera = stage->camera->name;
  report.to = options.to;
  report.width = options.common.width;
  report.height = options.common.height;
  scene::Camera target = stage->camera->camera;
  const scene::ScenePtr scene = options.to == "mirror" ? withMirror(*stage->scene, target) : stage->scene;
  report.instances = scene->placements.size();
  Arriving arriving(options, *stage, scene, target, *settings);
  for (const bool jump : {true, false})
    for (const bool mitigation : {true, false}) {
      if (options.mitigation != "both" && mitigation != (options.mitigation == "on")) continue;
      auto arrival = arriving.measure(mitigation, jump);
      if (!arrival) return arrival.error();
      report.arrivals.push_back(std::move(*arrival));
    }
  return publish(options.common, toJson(report).dump(2), toMarkdown(report), toSvg(report));
}

}  // namespace

void addJumpCommand(CLI::App& app, const std::string& command_line, Action& chosen) {
  const auto options = std::make_shared<JumpOptions>();
  CLI::App& command =
      *app.add_subcommand("jump", "what a camera jump costs: hits held, error and time by frame, until it settles");
  command.footer(kNotes);
  addCullingStageOptions(command, options->common, "heliograph.bench.jump/1");
  command.add_option("--mitigation", options->mitigation, "latency mitigation: on, off or both")
      ->capture_default_str()
      ->check(CLI::IsMember({"on", "off", "both"}));
  command.add_option("--to", options->to, "view: the camera's; mirror: the same, seen in a mirror alone")
      ->capture_default_str()
      ->check(CLI::IsMember({"view", "mirror"}));
  command.add_option("--pictures", options->pictures,
                     "folder for each frame's picture, and its difference from no culling, as PNG");
  command.add_option("--empty", options->empty, "ticks of the empty view ahead of the jump")->capture_default_str();
  command.add_option("--frames", options->frames, "after the jump, 1 to 10,000")
      ->capture_default_str()
      ->check(CLI::Range(1, 10'000).description(""));
  command.add_option("--settle", options->settle, "ticks after those, before hits are read, 2 to 10,000")
      ->capture_default_str()
      ->check(CLI::Range(2, 10'000).description(""));
  command.callback([&chosen, options, command_line] {
    chosen = [options, command_line] { return measureJump(*options, command_line); };
  });
}

}  // namespace helio::bench
