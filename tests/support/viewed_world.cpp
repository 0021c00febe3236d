#include "support/viewed_world.h"

#include <utility>

namespace helio::test {

Result<std::unique_ptr<ViewedWorld>> ViewedWorld::open(render::Renderer& renderer, scene::ScenePtr scene) {
  const auto handle = renderer.addWorld(scene);
  if (!handle) return handle.error();
  std::unique_ptr<ViewedWorld> result(new ViewedWorld(renderer, std::move(scene)));
  result->handle_ = *handle;
  const auto view = renderer.addView(*handle);
  if (!view) return view.error();
  result->view_ = *view;
  return result;
}

ViewedWorld::~ViewedWorld() {
  if (view_) renderer_.removeView(view_);
  if (handle_) renderer_.removeWorld(handle_);
}

Result<void> ViewedWorld::setLight(const scene::Environment& light) {
  return world_.apply(world_.seq() + 1, {{world::ResolvedEnvironment{light}}});
}

Result<render::Frame> ViewedWorld::tick(const scene::Camera& camera, const render::ViewSettings& settings,
                                        double seconds) {
  const render::ViewRequest request{view_, camera, settings};
  auto frames = renderer_.tick(handle_, world_.beginTick(seconds), {&request, 1});
  if (!frames) return frames.error();
  return std::move(frames->front());
}

render::ViewSettings referenceSettings(uint32_t width, uint32_t height) {
  render::ViewSettings settings;
  settings.width = width;
  settings.height = height;
  settings.mode = render::Mode::reference;
  settings.auto_exposure = false;
  settings.keep_radiance = true;
  return settings;
}

}  // namespace helio::test
