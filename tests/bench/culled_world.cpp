#include "bench/culled_world.h"

#include <chrono>
#include <iostream>

#include "bench/files.h"
#include "bench/progress.h"
#include "bench/settings.h"

namespace helio::bench {

void addCullingStageOptions(CLI::App& command, CullingStage& options, const std::string& schema) {
  addStageOptions(command, options.stage);
  addSizeOption(command, options.width, options.height);
  addSettingOptions(command, options.settings);
  command.add_option("--device", options.device,
                     "part of a Vulkan device's name, cpu or gpu; default: HELIOGRAPH_DEVICE, then the best there is");
  command.add_flag("--json", options.json, "one JSON document, schema " + schema);
  command.add_option("--plot", options.plot, "SVG file for the plot");
}

Result<render::ViewSettings> viewSettings(const CullingStage& options) {
  render::ViewSettings settings;
  settings.width = options.width;
  settings.height = options.height;
  settings.accumulate = settings.auto_exposure = false;
  settings.keep_radiance = true;
  if (auto valid = apply(options.settings, settings); !valid) return valid.error();
  return settings;
}

Result<OpenStage> openStage(const CullingStage& options) {
  if (auto valid = check(options.stage); !valid) return valid.error();
  render::RendererOptions renderer_options;
  renderer_options.device = options.device;
  auto renderer = render::makeRenderer(renderer_options);
  if (!renderer) return renderer.error();
  const Progress progress("making the scene");
  const auto scene = makeScene(options.stage);
  if (!scene) return scene.error();
  const auto camera = findCamera(**scene, options.stage.camera);
  if (!camera) return camera.error();
  return OpenStage{std::move(*renderer), *scene, *camera};
}

Result<std::unique_ptr<CulledWorld>> CulledWorld::open(render::Renderer& renderer, scene::ScenePtr scene,
                                                       const scene::Environment& light, render::Culling culling,
                                                       const render::CullingSettings& settings) {
  std::unique_ptr<CulledWorld> result(new CulledWorld(renderer, scene, light));
  const auto handle = renderer.addWorld(scene);
  if (!handle) return handle.error();
  result->handle_ = *handle;
  if (auto set = renderer.setCulling(*handle, culling, settings); !set) return set.error();
  if (auto viewed = result->attach(); !viewed) return viewed.error();
  return result;
}

CulledWorld::~CulledWorld() {
  if (handle_) renderer_.removeWorld(handle_);
}

Result<void> CulledWorld::attach() {
  const auto view = renderer_.addView(handle_);
  if (!view) return view.error();
  views_.push_back(*view);
  return {};
}

Result<std::vector<render::Frame>> CulledWorld::tick(std::span<const scene::Camera> cameras,
                                                     const render::ViewSettings& settings, double seconds) {
  world::ChangeSet changes = world_.beginTick(seconds);
  changes.environment = light_;
  std::vector<render::ViewRequest> requests;
  for (size_t i = 0; i < cameras.size(); ++i) requests.push_back({views_.at(i), cameras[i], settings});
  const auto start = std::chrono::steady_clock::now();
  auto frames = renderer_.tick(handle_, changes, requests);
  wall_ms_ = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  return frames;
}

Result<render::Frame> CulledWorld::tick(const scene::Camera& camera, const render::ViewSettings& settings,
                                        double seconds) {
  auto frames = tick({&camera, 1}, settings, seconds);
  if (!frames) return frames.error();
  return std::move(frames->front());
}

Result<Image> CulledWorld::still(std::span<const scene::Camera> cameras, render::ViewSettings settings,
                                 uint32_t samples, size_t view) {
  renderer_.removeView(views_.at(view));
  const auto fresh = renderer_.addView(handle_);
  if (!fresh) return fresh.error();
  views_.at(view) = *fresh;
  settings.samples = 8;
  settings.accumulate = true;
  render::Frame last;
  for (uint32_t n = 0; n < samples; n += settings.samples) {
    auto frames = tick(cameras, settings, 0.0);
    if (!frames) return frames.error();
    last = std::move(frames->at(view));
  }
  return imageOf(std::move(last));
}

Image imageOf(render::Frame&& frame) { return {frame.pixels->width, frame.pixels->height, std::move(frame.radiance)}; }

double passMs(const render::FrameStats& frame, std::initializer_list<const char*> passes) {
  double ms = 0.0;
  for (const render::PassTime& time : frame.passes)
    for (const char* pass : passes)
      if (time.name == pass) ms += time.ms;
  return ms;
}

Result<void> publish(const CullingStage& options, const std::string& json, const std::string& markdown,
                     const std::string& svg) {
  std::cout << (options.json ? json + "\n" : markdown) << std::flush;
  return options.plot.empty() ? Result<void>() : writeFile(options.plot, svg);
}

}  // namespace helio::bench
