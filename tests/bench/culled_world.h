// A world under a culling strategy, seen by any number of cameras: what the benchmarks of culling have in common.
#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bench/image.h"
#include "bench/stage.h"
#include "render/renderer.h"

namespace helio::bench {

/// What they are all asked for.
struct CullingStage {
  StageOptions stage;
  uint32_t width = 320, height = 180;
  std::vector<std::string> settings;  ///< of the views: NAME=VALUE
  std::string device;
  std::string plot;  ///< an SVG file; empty: none
  bool json = false;
};
/// --scene ..., --size, --set, --device, --plot and --json, which refer to `options` from then on. `schema`: of the
/// JSON document.
void addCullingStageOptions(CLI::App& command, CullingStage& options, const std::string& schema);
/// The views' settings: no average over ticks, a fixed exposure, radiance kept. Errors: --set.
Result<render::ViewSettings> viewSettings(const CullingStage& options);

/// Renderer, scene and camera that the options name.
struct OpenStage {
  std::unique_ptr<render::Renderer> renderer;
  scene::ScenePtr scene;
  const scene::NamedCamera* camera;  // of the scene
};
Result<OpenStage> openStage(const CullingStage& options);

class CulledWorld {
 public:
  static constexpr double kTick = 1.0 / 60.0;  ///< seconds of world time

  /// `light`: in the place of the scene's. Errors: the renderer's.
  static Result<std::unique_ptr<CulledWorld>> open(render::Renderer& renderer, scene::ScenePtr scene,
                                                   const scene::Environment& light, render::Culling culling,
                                                   const render::CullingSettings& settings = {});
  ~CulledWorld();
  CulledWorld(const CulledWorld&) = delete;
  CulledWorld& operator=(const CulledWorld&) = delete;

  /// One more camera looks from the next tick on.
  Result<void> attach();
  /// One tick, seen by one camera a view; their frames, in order.
  Result<std::vector<render::Frame>> tick(std::span<const scene::Camera> cameras, const render::ViewSettings& settings,
                                          double seconds = kTick);
  Result<render::Frame> tick(const scene::Camera& camera, const render::ViewSettings& settings, double seconds = kTick);
  /// The mean of `samples` a pixel (a multiple of 8) while time stands; the same random numbers in all worlds whose
  /// views are equally many. By the first view, in a new one's place.
  Result<Image> still(std::span<const scene::Camera> cameras, render::ViewSettings settings, uint32_t samples,
                      size_t view = 0);
  Result<std::vector<render::CulledInstance>> instances() { return renderer_.culledInstances(handle_); }
  double wallMs() const { return wall_ms_; }  ///< of the last tick, the CPU's part included

 private:
  CulledWorld(render::Renderer& renderer, scene::ScenePtr scene, const scene::Environment& light)
      : renderer_(renderer), world_(std::move(scene)), light_(light) {}

  render::Renderer& renderer_;
  world::World world_;
  scene::Environment light_;
  render::WorldHandle handle_ = 0;
  std::vector<render::ViewHandle> views_;
  double wall_ms_ = 0.0;
};

/// Of a frame with radiance.
Image imageOf(render::Frame&& frame);
/// Sum of the passes of these names.
double passMs(const render::FrameStats& frame, std::initializer_list<const char*> passes);
/// Prints JSON or the table, and writes the plot where one is asked for.
Result<void> publish(const CullingStage& options, const std::string& json, const std::string& markdown,
                     const std::string& svg);

}  // namespace helio::bench
