// A world with one view, ticked by hand: what tests and benchmarks render pictures with.
#pragma once

#include <memory>

#include "render/renderer.h"
#include "world/world.h"

namespace helio::test {

/// Removes itself from the renderer at its end.
class ViewedWorld {
 public:
  /// Errors: the renderer's.
  static Result<std::unique_ptr<ViewedWorld>> open(render::Renderer& renderer, scene::ScenePtr scene);
  ~ViewedWorld();
  ViewedWorld(const ViewedWorld&) = delete;
  ViewedWorld& operator=(const ViewedWorld&) = delete;

  /// Replaces sun and sky, from the next tick on. Errors: the world's.
  Result<void> setLight(const scene::Environment& light);
  /// One tick, `seconds` of world time later. Errors: the renderer's.
  Result<render::Frame> tick(const scene::Camera& camera, const render::ViewSettings& settings,
                             double seconds = 1.0 / 60.0);
  world::World& world() { return world_; }
  render::WorldHandle handle() const { return handle_; }

 private:
  ViewedWorld(render::Renderer& renderer, scene::ScenePtr scene) : renderer_(renderer), world_(std::move(scene)) {}

  render::Renderer& renderer_;
  world::World world_;
  render::WorldHandle handle_ = 0;
  render::ViewHandle view_ = 0;
};

/// Small, reference, radiance kept, fixed exposure.
render::ViewSettings referenceSettings(uint32_t width = 64, uint32_t height = 64);

}  // namespace helio::test
