#include "bench/culling.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <functional>
#include <iostream>
#include <map>

#include "bench/culled_world.h"
#include "bench/files.h"
#include "bench/image.h"
#include "bench/progress.h"
#include "bench/settings.h"

namespace helio::bench {
namespace {

constexpr const char* kNotes = R"(What is measured:
  A city in which everything moves, seen by one of its cameras. Every strategy has a world of its own; their ticks
  alternate, so whatever slows the machine down meets all of them alike. full: everything is in the TLAS.
  frustum_radius: what is in the frustum or within 800 m. lipac: what light paths meet; lipac_literal: by the paper's
  rules to the letter; lipac_any_hit: boxes are any-hit geometry; lipac_frozen: lipac, but behind the warm-up nothing is
  counted any more and nothing changes, which shows what counting costs. distance: as many instances as lipac holds then, the
  nearest. none: nothing but what is too large to be culled; pictures must fail it.
  Then time stands still, culling is frozen, and the pictures of all strategies are averaged over the same samples: their
  errors are against full. Indirect light is the picture without what paths of one scattering bring.

Examples:
  helio-bench culling --camera animated_models --instances 2000 --animated 500 --size 160x90 --frames 5
  helio-bench culling --camera tilted_city --instances 100000 --animated 6000 --size 1920x1080 --device NVIDIA --json)";

class Contestant {
 public:
  static Result<std::unique_ptr<Contestant>> start(render::Renderer& renderer, const CullingOptions& options,
                                                   const scene::ScenePtr& scene, const scene::NamedCamera& camera,
                                                   const std::string& strategy) {
    std::unique_ptr<Contestant> result(new Contestant(renderer, options, scene, camera, strategy));
    const auto handle = renderer.addWorld(scene);
    if (!handle) return handle.error();
    result->handle_ = *handle;
    render::CullingSettings settings;
    settings.lipac.literal = strategy == "lipac_literal";
    settings.lipac.counted_paths = options.counted_paths;
    settings.lipac.smoothing = options.smoothing;
    if (strategy == "lipac_any_hit") settings.lipac.box_hits = accel::BoxHits::any_hit;
    const bool guided = strategy.starts_with("lipac");
    // distance begins when it is known how many lipac holds.
    const render::Culling culling = guided                         ? render::Culling::lipac
                                    : strategy == "frustum_radius" ? render::Culling::frustum_radius
                                    : strategy == "none"           ? render::Culling::none
                                                                   : render::Culling::full;
    if (auto set = renderer.setCulling(*handle, culling, settings); !set) return set.error();
    if (auto viewed = result->newView(); !viewed) return viewed.error();
    return result;
  }
  ~Contestant() {
    if (handle_) renderer_.removeWorld(handle_);
  }

  Result<void> tick(double seconds, bool measured) {
    render::ViewSettings settings = base();
    settings.accumulate = false;
    const auto frame = render(seconds, settings);
    if (!frame) return frame.error();
    if (measured) frames_.push_back(frame->stats);
    active_ = frame->stats.lipac ? frame->stats.lipac->active : frame->stats.tlas_instances;
    return {};
  }

  /// The nearest `count` instances from now on.
  Result<void> holdNearest(uint32_t count) {
    std::vector<float> distances;
    for (const scene::Placement& placed : world_.scene().placements)
      distances.push_back(glm::distance(glm::vec3(placed.transform[3]), camera_.camera.position));
    const size_t last = std::min<size_t>(std::max(count, 1u), distances.size()) - 1;
    std::nth_element(distances.begin(), distances.begin() + static_cast<ptrdiff_t>(last), distances.end());
    render::CullingSettings settings;
    settings.radius = std::max(distances[last], 0.001f);
    return renderer_.setCulling(handle_, render::Culling::distance, settings);
  }

  const std::string& strategy() const { return strategy_; }
  uint32_t active() const { return active_; }
  Result<void> freeze() { return renderer_.freezeCulling(handle_, true); }

  /// The mean of the options' samples while time stands, in a view of its own: all contestants draw the same samples.
  /// Of a frozen world, so that what two pictures differ by is not what was culled in between.
  Result<Image> still(uint32_t bounces) {
    if (auto viewed = newView(); !viewed) return viewed.error();
    render::ViewSettings settings = base();
    settings.bounces = bounces;
    settings.auto_exposure = false;
    settings.samples = 8;
    render::Frame last;
    for (uint32_t n = 0; n < options_.samples; n += settings.samples) {
      settings.keep_radiance = n + settings.samples >= options_.samples;
      auto frame = render(0.0, settings);
      if (!frame) return frame.error();
      last = std::move(*frame);
    }
    return Image{options_.width, options_.height, std::move(last.radiance)};
  }

  CullingRun summary() const {
    const auto of = [this](const std::function<double(const render::FrameStats&)>& value) {
      std::vector<double> values;
      for (const render::FrameStats& frame : frames_) values.push_back(value(frame));
      return summarise(values);
    };
    using Stats = render::FrameStats;
    CullingRun run;
    run.strategy = strategy_;
    run.tlas_instances = of([](const Stats& f) { return double(f.tlas_instances); });
    run.own_blas_count = of([](const Stats& f) { return double(f.acceleration.own_blases); });
    run.own_blas_in_view = of([](const Stats& f) { return double(f.acceleration.own_blases_in_view); });
    run.blas_triangles = of([](const Stats& f) { return double(f.acceleration.blas_triangles); });
    run.shadow_triangles = of([](const Stats& f) { return double(f.shadow_triangles); });
    run.skin_ms = of([](const Stats& f) { return passMs(f, {"pose", "deform"}); });
    run.blas_ms = of([](const Stats& f) { return passMs(f, {"blas"}); });
    run.tlas_ms = of([](const Stats& f) { return passMs(f, {"tlas"}); });
    run.assemble_ms = of([](const Stats& f) { return passMs(f, {"assemble"}); });
    run.feedback_ms = of([](const Stats& f) { return passMs(f, {"feedback"}); });
    run.state_changes = of([](const Stats& f) { return f.lipac ? double(f.lipac->changes) : 0.0; });
    for (const Stats& frame : frames_) run.cycles += frame.lipac ? frame.lipac->cycles : 0;
    run.states = frames_.back().lipac;
    run.path_trace_ms = of([](const Stats& f) { return passMs(f, {"path_trace"}); });
    run.shadow_ms = of([](const Stats& f) { return passMs(f, {"shadow_cull", "shadow_map"}); });
    run.primary_ms = of([](const Stats& f) { return passMs(f, {"cull", "primary_raster", "primary_traced"}); });
    run.frame_ms = of([](const Stats& f) { return f.gpu_ms; });
    run.span_ms = of([](const Stats& f) { return f.span_ms; });
    run.memory = frames_.back().acceleration;
    run.working_set_bytes = frames_.back().memory.working_set;
    run.cpu_bytes = frames_.back().memory.cpu;
    return run;
  }

 private:
  Contestant(render::Renderer& renderer, const CullingOptions& options, const scene::ScenePtr& scene,
             const scene::NamedCamera& camera, const std::string& strategy)
      : renderer_(renderer), options_(options), world_(scene), camera_(camera), strategy_(strategy) {}

  render::ViewSettings base() const {
    render::ViewSettings settings;
    settings.width = options_.width;
    settings.height = options_.height;
    (void)apply(options_.settings, settings);  // checked when the benchmark began
    return settings;
  }
  Result<void> newView() {
    if (view_) renderer_.removeView(view_);
    const auto view = renderer_.addView(handle_);
    if (!view) return view.error();
    view_ = *view;
    return {};
  }
  Result<render::Frame> render(double seconds, const render::ViewSettings& settings) {
    world::ChangeSet changes = world_.beginTick(seconds);
    changes.environment = camera_.environment;
    const render::ViewRequest request{view_, camera_.camera, settings};
    auto frames = renderer_.tick(handle_, changes, {&request, 1});
    if (!frames) return frames.error();
    return std::move(frames->front());
  }

  render::Renderer& renderer_;
  const CullingOptions& options_;
  world::World world_;
  const scene::NamedCamera& camera_;
  std::string strategy_;
  uint32_t active_ = 0;  // instances in the last tick's TLAS
  render::WorldHandle handle_ = 0;
  render::ViewHandle view_ = 0;
  std::vector<render::FrameStats> frames_;
};

Image difference(const Image& a, const Image& b) {
  Image result = a;
  for (size_t i = 0; i < a.rgb.size(); ++i) result.rgb[i] -= b.rgb[i];
  return result;
}

/// `distance` holds as many instances as `lipac` does.
Result<void> matchDistance(const std::vector<std::unique_ptr<Contestant>>& contestants) {
  const auto find = [&](const std::string& strategy) {
    return std::find_if(contestants.begin(), contestants.end(),
                        [&](const auto& c) { return c->strategy() == strategy; });
  };
  const auto lipac = find("lipac"), distance = find("distance");
  return distance == contestants.end() ? Result<void>() : (*distance)->holdNearest((*lipac)->active());
}

Result<void> measureCulling(const CullingOptions& options, const std::string& command_line) {
  render::ViewSettings probe;
  if (auto valid = apply(options.settings, probe); !valid) return valid;
  render::RendererOptions renderer_options;
  renderer_options.device = options.device;
  renderer_options.builds_aside = options.builds_aside;
  renderer_options.one_call_a_blas = options.one_call_a_blas;
  auto renderer = render::makeRenderer(renderer_options);
  if (!renderer) return renderer.error();
  CullingReport report;
  report.provenance = provenance((*renderer)->device(), command_line);
  const Result<scene::ScenePtr> scene = [&] {
    const Progress progress("making the scene");
    return makeScene(options.stage);
  }();
  if (!scene) return scene.error();
  const auto camera = findCamera(**scene, options.stage.camera);
  if (!camera) return camera.error();
  report.camera = (*camera)->name;
  report.instances = (*scene)->placements.size();
  report.animated = options.stage.animated.value_or(0);
  report.width = options.width;
  report.height = options.height;
  report.frames = options.frames;
  report.warmup = options.warmup;
  report.samples = options.samples;

  constexpr double kTick = 1.0 / 60.0;
  std::vector<std::unique_ptr<Contestant>> contestants;
  for (const std::string& strategy : options.strategies) {
    auto contestant = Contestant::start(**renderer, options, *scene, **camera, strategy);
    if (!contestant) return contestant.error();
    contestants.push_back(std::move(*contestant));
  }
  {
    Progress progress("measuring", options.warmup + options.frames);
    for (uint32_t i = 0; i < options.warmup + options.frames; ++i, progress.step()) {
      // Half of the warm-up settles lipac; the other brings distance the BLASes that it wants.
      if (i == options.warmup / 2)
        if (auto done = matchDistance(contestants); !done) return done;
      if (i == options.warmup)
        for (auto& contestant : contestants)
          if (contestant->strategy() == "lipac_frozen")
            if (auto done = contestant->freeze(); !done) return done;
      for (auto& contestant : contestants)
        if (auto done = contestant->tick(kTick, i >= options.warmup); !done) return done;
    }
  }
  std::vector<Image> composites, indirects;
  {
    Progress progress("comparing pictures", contestants.size());
    for (auto& contestant : contestants) {
      if (auto done = contestant->freeze(); !done) return done;
      auto composite = contestant->still(render::ViewSettings{}.bounces);
      if (!composite) return composite.error();
      const auto direct = contestant->still(0);
      if (!direct) return direct.error();
      indirects.push_back(difference(*composite, *direct));
      composites.push_back(std::move(*composite));
      progress.step();
    }
  }
  for (size_t i = 0; i < contestants.size(); ++i) {
    report.runs.push_back(contestants[i]->summary());
    report.runs.back().composite = {relativeMse(composites[i], composites[0]), ssim(composites[i], composites[0])};
    report.runs.back().indirect = {relativeMse(indirects[i], indirects[0]), ssim(indirects[i], indirects[0])};
    if (!options.pictures.empty())
      if (auto written = writePictures(options.pictures, options.strategies[i], composites[i], composites[0]); !written)
        return written;
  }
  std::cout << (options.json ? toJson(report).dump(2) + "\n" : toMarkdown(report)) << std::flush;
  if (!std::cout) return Error{ErrorKind::internal, "cannot write the result to standard output", {}, {}, {}};
  return options.plot.empty() ? Result<void>() : writeFile(options.plot, toSvg(report));
}

}  // namespace

void addCullingCommand(CLI::App& app, const std::string& command_line, Action& chosen) {
  const auto options = std::make_shared<CullingOptions>();
  CLI::App& command =
      *app.add_subcommand("culling", "compares the culling strategies: times, memory and error by strategy");
  command.footer(kNotes);
  addStageOptions(command, options->stage);
  addSizeOption(command, options->width, options->height);
  command.add_option("--frames", options->frames, "measured, 1 to 100,000")
      ->capture_default_str()
      ->check(CLI::Range(1, 100'000).description(""));
  command.add_option("--warmup", options->warmup, "ticks before the first measured one")->capture_default_str();
  command.add_option("--samples", options->samples, "a pixel, averaged for the image error; a multiple of 8")
      ->capture_default_str()
      ->check(CLI::Range(8, 1'000'000).description(""));
  command.add_option("--strategies", options->strategies, "full, then what is compared with it; distance needs lipac")
      ->delimiter(',')
      ->capture_default_str()
      ->check(CLI::IsMember(
          {"full", "frustum_radius", "lipac", "lipac_literal", "lipac_any_hit", "lipac_frozen", "none", "distance"}));
  addSettingOptions(command, options->settings);
  command.add_option("--smoothing", options->smoothing, "of lipac: ticks that hits are averaged over")
      ->capture_default_str()
      ->check(CLI::Range(1, 64).description("1 to 64"));
  command.add_option("--counted-paths", options->counted_paths, "of lipac: paths a tick that count, at most")
      ->capture_default_str()
      ->check(CLI::Range(1024, 16'777'216).description(""));
  command.add_flag("--builds-aside", options->builds_aside,
                   "acceleration structures are built beside what is rasterised, and not before it");
  command.add_flag("--one-call-a-blas", options->one_call_a_blas,
                   "builds BLASes of instances' own one by one: what the batch saves");
  command.add_option("--pictures", options->pictures, "folder for each strategy's picture and its error as PNG");
  command.add_option("--device", options->device,
                     "part of a Vulkan device's name, cpu or gpu; default: HELIOGRAPH_DEVICE, then the best there is");
  command.add_flag("--json", options->json, "one JSON document, schema heliograph.bench.culling/1");
  command.add_option("--plot", options->plot, "SVG file for bars of times and memory");
  command.callback([&chosen, options, command_line] {
    const std::vector<std::string>& strategies = options->strategies;
    if (strategies.empty() || strategies.front() != "full")
      throw CLI::ValidationError("--strategies", "errors are against full: give it first");
    const auto has = [&](const char* name) {
      return std::find(strategies.begin(), strategies.end(), name) != strategies.end();
    };
    if (has("distance") && !has("lipac"))
      throw CLI::ValidationError("--strategies", "distance holds as many instances as lipac: give lipac too");
    if (auto valid = check(options->stage); !valid) throw CLI::ValidationError("--scene", valid.error().message);
    chosen = [options, command_line] { return measureCulling(*options, command_line); };
  });
}

}  // namespace helio::bench
