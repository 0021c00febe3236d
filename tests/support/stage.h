// A world on the test device (lavapipe unless HELIOGRAPH_DEVICE says otherwise) with the validation layer on.
#pragma once

#include <gtest/gtest.h>

#include <memory>

#include "scene/scene.h"
#include "support/viewed_world.h"

namespace helio::test {

/// The process's renderer, strict about validation. No device is a failure, never a skip.
render::Renderer& renderer();

/// One world with one view, on the process's renderer.
class Stage {
 public:
  explicit Stage(scene::ScenePtr scene);

  /// Ticks once; a failure throws, and so fails the test.
  render::Frame tick(const scene::Camera& camera, const render::ViewSettings& settings);
  /// Ticks `count` times with a still camera; the last frame.
  render::Frame accumulate(const scene::Camera& camera, const render::ViewSettings& settings, uint32_t count);
  void edit(const std::vector<world::Edit>& edits);
  /// Seconds that a tick advances the world's clock by; 1/60 at first.
  void setStep(double seconds) { step_ = seconds; }
  void setCulling(render::Culling culling, const render::CullingSettings& settings = {});
  render::WorldHandle handle() const { return viewed_->handle(); }
  world::World& world() { return viewed_->world(); }

 private:
  std::unique_ptr<ViewedWorld> viewed_;
  double step_ = 1.0 / 60.0;
};

glm::vec3 texel(const render::Frame& frame, uint32_t x, uint32_t y);
glm::vec3 mean(const render::Frame& frame);
std::vector<uint8_t> bytes(const render::Frame& frame);
bool recorded(const render::Frame& frame, const std::string& pass);
/// Writes linear radiance as a tone-mapped PNG below HELIOGRAPH_TEST_PICTURES, if that is set: for people to look at.
void showPicture(const render::Frame& frame, const std::string& name);

}  // namespace helio::test
