#include "bench/edit_storm.h"

#include <spdlog/fmt/fmt.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <iostream>
#include <memory>

#include "bench/files.h"
#include "bench/progress.h"
#include "bench/report.h"
#include "bench/stage.h"
#include "bench/statistics.h"
#include "render/renderer.h"

namespace helio::bench {
namespace {

constexpr const char* kNotes = R"(What is measured:
  Ticks of a city in which units walk. After some that settle, one command builds instances while the camera jumps to
  the scene's next view; later one command destroys them, and the camera jumps back. wall_ms is what a tick takes the
  thread of its world, from the change set to the picture. An edit is complete with the first tick that shows it and
  leaves no BLAS waiting.

Examples:
  helio-bench edit-storm --instances 2000 --animated 500 --edit 2000 --size 160x90
  helio-bench edit-storm --instances 100000 --animated 6000 --size 1920x1080 --device NVIDIA --plot storm.svg)";

struct Options {
  StageOptions stage;
  uint32_t width = 320, height = 180;
  uint32_t edit = 10'000;
  uint32_t ticks = 30;  ///< before, between and after the edits
  double budget_ms = 50.0;
  std::string prefab = "tree_birch", device, plot;
  bool json = false;
};

struct Tick {
  double wall_ms = 0.0, gpu_ms = 0.0;
  uint32_t waiting = 0;
  uint64_t memory = 0;  ///< of the world's acceleration structures, bytes
};

/// One of the two edits.
struct Phase {
  std::string edit;
  uint32_t first_tick = 0;
  uint32_t complete_after = 0;  ///< ticks, the first included
  double longest_ms = 0.0;      ///< of those
};

class Storm {
 public:
  Storm(const Options& options, render::Renderer& renderer, scene::ScenePtr scene)
      : options_(options), renderer_(renderer), scene_(std::move(scene)), world_(scene_) {}
  ~Storm() {
    if (handle_) renderer_.removeWorld(handle_);
  }

  Result<void> run() {
    const auto handle = renderer_.addWorld(scene_);
    if (!handle) return handle.error();
    handle_ = *handle;
    const auto view = renderer_.addView(handle_);
    if (!view) return view.error();
    view_ = *view;
    const auto camera = findCamera(*scene_, options_.stage.camera);
    if (!camera) return camera.error();
    camera_ = static_cast<size_t>(*camera - scene_->cameras.data());

    Progress progress("ticking", size_t{4} * options_.ticks);
    if (auto done = ticks(2 * options_.ticks, progress); !done) return done;
    settled_from_ = static_cast<size_t>(options_.ticks);  // the first half fills tables and caches
    const auto built = buildMany();
    if (!built) return built.error();
    if (auto done = phase("build", world::Edit{*built}, progress); !done) return done;
    world::Destroy destroy;
    for (uint64_t i = 0; i < options_.edit; ++i) destroy.ids.push_back(scene_->placements.size() + 1 + i);
    return phase("destroy", world::Edit{destroy}, progress);
  }

  double settledMs() const {
    std::vector<double> settled;
    for (size_t i = settled_from_; i < size_t{2} * options_.ticks; ++i) settled.push_back(ticks_[i].wall_ms);
    return median(settled);
  }
  const std::vector<Tick>& series() const { return ticks_; }
  const std::vector<Phase>& phases() const { return phases_; }
  uint64_t memoryBefore() const { return ticks_[size_t{2} * options_.ticks - 1].memory; }
  uint64_t memoryAfter() const { return ticks_.back().memory; }

 private:
  /// A square of instances over the middle of the world.
  Result<world::Build> buildMany() const {
    if (scene_->findPrefab(options_.prefab) == scene::kNone)
      return Error{
          ErrorKind::not_found, "the scene has no prefab \"" + options_.prefab + "\"", "--prefab", options_.prefab, {}};
    world::Build build{options_.prefab, {}};
    const auto side = static_cast<uint32_t>(std::ceil(std::sqrt(static_cast<double>(options_.edit))));
    for (uint32_t i = 0; i < options_.edit; ++i) {
      world::Pose pose;
      const glm::vec2 xz = 3.0f * (glm::vec2(i % side, i / side) - 0.5f * static_cast<float>(side));
      const float y = scene_->ground.columns > 0 ? scene_->ground.height(xz) : 0.0f;
      pose.position = {xz.x, y, xz.y};
      build.poses.push_back(pose);
    }
    return build;
  }

  Result<void> ticks(uint32_t count, Progress& progress) {
    for (uint32_t i = 0; i < count; ++i, progress.step()) {
      const auto start = std::chrono::steady_clock::now();
      world::ChangeSet changes = world_.beginTick(1.0 / 60.0);
      changes.environment = scene_->cameras[camera_].environment;
      render::ViewSettings settings;
      settings.width = options_.width;
      settings.height = options_.height;
      settings.accumulate = false;
      const render::ViewRequest request{view_, scene_->cameras[camera_].camera, settings};
      const auto frames = renderer_.tick(handle_, changes, {&request, 1});
      if (!frames) return frames.error();
      const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - start;
      const render::FrameStats& stats = frames->front().stats;
      ticks_.push_back({took.count(), stats.gpu_ms, stats.acceleration.own_blases_waiting, stats.acceleration.total()});
    }
    return {};
  }

  Result<void> phase(const std::string& name, const world::Edit& edit, Progress& progress) {
    const auto batch = world_.resolve({&edit, 1});
    if (!batch) return batch.error();
    if (auto applied = world_.apply(world_.seq() + 1, *batch); !applied) return applied;
    camera_ = (camera_ + 1) % scene_->cameras.size();
    Phase phase{name, static_cast<uint32_t>(ticks_.size()), 0, 0.0};
    if (auto done = ticks(options_.ticks, progress); !done) return done;
    for (size_t i = phase.first_tick; i < ticks_.size(); ++i) {
      ++phase.complete_after;
      phase.longest_ms = std::max(phase.longest_ms, ticks_[i].wall_ms);
      if (ticks_[i].waiting == 0) break;
    }
    phases_.push_back(phase);
    return {};
  }

  const Options& options_;
  render::Renderer& renderer_;
  scene::ScenePtr scene_;
  world::World world_;
  render::WorldHandle handle_ = 0;
  render::ViewHandle view_ = 0;
  size_t camera_ = 0, settled_from_ = 0;
  std::vector<Tick> ticks_;
  std::vector<Phase> phases_;
};

std::string svgOf(const Storm& storm, double limit) {
  constexpr double kWidth = 720.0, kHeight = 300.0, kLeft = 50.0, kTop = 20.0;
  double most = limit;
  for (const Tick& tick : storm.series()) most = std::max(most, tick.wall_ms);
  const auto x = [&](size_t i) {
    return kLeft + kWidth * static_cast<double>(i) / static_cast<double>(storm.series().size());
  };
  const auto y = [&](double ms) { return kTop + kHeight * (1.0 - ms / (1.05 * most)); };
  std::string svg =
      "<svg xmlns='http://www.w3.org/2000/svg' width='800' height='360' font-family='sans-serif' font-size='11'>\n"
      "<rect width='800' height='360' fill='white'/>\n";
  for (const Phase& phase : storm.phases())
    svg += fmt::format(
        "<line x1='{0:.1f}' x2='{0:.1f}' y1='{1}' y2='{2}' stroke='#c8752d'/><text x='{0:.1f}' y='14'>{3}</text>\n",
        x(phase.first_tick), kTop, kTop + kHeight, phase.edit);
  svg += fmt::format("<line x1='{}' x2='{}' y1='{:.1f}' y2='{:.1f}' stroke='#999' stroke-dasharray='4'/>\n", kLeft,
                     kLeft + kWidth, y(limit), y(limit));
  svg += "<polyline fill='none' stroke='#35618f' points='";
  for (size_t i = 0; i < storm.series().size(); ++i)
    svg += fmt::format("{:.1f},{:.1f} ", x(i), y(storm.series()[i].wall_ms));
  svg += fmt::format("'/>\n<text x='4' y='{:.1f}'>{:.0f} ms</text><text x='4' y='{:.1f}'>0</text>\n", y(most) + 4.0,
                     most, y(0.0));
  return svg + fmt::format("<text x='{}' y='345'>ticks; dashed: twice the settled median and the budget</text></svg>\n",
                           kLeft);
}

Result<void> measureStorm(const Options& options, const std::string& command_line) {
  auto renderer = render::makeRenderer({options.device});
  if (!renderer) return renderer.error();
  const Provenance origin = provenance((*renderer)->device(), command_line);
  const Result<scene::ScenePtr> scene = makeScene(options.stage);
  if (!scene) return scene.error();
  Storm storm(options, **renderer, *scene);
  if (auto done = storm.run(); !done) return done;
  const double settled = storm.settledMs(), limit = 2.0 * settled + options.budget_ms;

  if (options.json) {
    Json json = {{"schema", "heliograph.bench.edit_storm/1"}};
    append(json, origin);
    json["instances"] = (*scene)->placements.size();
    json["animated"] = options.stage.animated.value_or(0);
    json["edit"] = options.edit;
    json["prefab"] = options.prefab;
    json["settled_ms"] = settled;
    json["budget_ms"] = options.budget_ms;
    json["limit_ms"] = limit;
    json["memory_bytes"] = {{"before", storm.memoryBefore()}, {"after", storm.memoryAfter()}};
    json["phases"] = Json::array();
    for (const Phase& phase : storm.phases())
      json["phases"].push_back({{"edit", phase.edit},
                                {"first_tick", phase.first_tick},
                                {"complete_after_ticks", phase.complete_after},
                                {"longest_ms", phase.longest_ms},
                                {"within_limit", phase.longest_ms <= limit}});
    json["ticks"] = Json::array();
    for (const Tick& tick : storm.series())
      json["ticks"].push_back({{"wall_ms", tick.wall_ms},
                               {"gpu_ms", tick.gpu_ms},
                               {"waiting", tick.waiting},
                               {"memory_bytes", tick.memory}});
    std::cout << json.dump(2) << std::endl;
  } else {
    std::cout << fmt::format("# Edit storm: {} instances of {} in one command, {} there before\n\n{}",
                             grouped(options.edit), options.prefab, grouped((*scene)->placements.size()),
                             markdown(origin))
              << fmt::format(
                     "- settled tick: {:.2f} ms; limit: twice that and {:.0f} ms = {:.2f} ms\n- memory for ray "
                     "tracing: {} MB before, {} MB after\n\n",
                     settled, options.budget_ms, limit, megabytes(storm.memoryBefore()),
                     megabytes(storm.memoryAfter()));
    Table table({"edit", "complete after, ticks", "longest tick, ms", "within the limit"});
    for (const Phase& phase : storm.phases())
      table.add({phase.edit, std::to_string(phase.complete_after), fixed(phase.longest_ms, 2),
                 phase.longest_ms <= limit ? "yes" : "no"});
    std::cout << table.markdown() << std::flush;
  }
  return options.plot.empty() ? Result<void>() : writeFile(options.plot, svgOf(storm, limit));
}

}  // namespace

void addEditStormCommand(CLI::App& app, const std::string& command_line, Action& chosen) {
  const auto options = std::make_shared<Options>();
  CLI::App& command = *app.add_subcommand("edit-storm", "times ticks around mass edits");
  command.footer(kNotes);
  addStageOptions(command, options->stage);
  addSizeOption(command, options->width, options->height);
  command.add_option("--edit", options->edit, "instances that one command builds, then destroys")
      ->capture_default_str()
      ->check(CLI::Range(1, 100'000).description(""));
  command.add_option("--prefab", options->prefab, "what is built")->capture_default_str();
  command.add_option("--ticks", options->ticks, "twice as many before the first edit, as many after each")
      ->capture_default_str()
      ->check(CLI::Range(2, 100'000).description(""));
  command
      .add_option("--budget-ms", options->budget_ms, "what an edit may add to a tick beyond twice the settled median")
      ->capture_default_str();
  command.add_option("--device", options->device,
                     "part of a Vulkan device's name, cpu or gpu; default: HELIOGRAPH_DEVICE, then the best there is");
  command.add_flag("--json", options->json, "one JSON document, schema heliograph.bench.edit_storm/1");
  command.add_option("--plot", options->plot, "SVG file for the series of ticks");
  command.callback([&chosen, options, command_line] {
    if (auto valid = check(options->stage); !valid) throw CLI::ValidationError("--scene", valid.error().message);
    chosen = [options, command_line] { return measureStorm(*options, command_line); };
  });
}

}  // namespace helio::bench
