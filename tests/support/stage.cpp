#include "support/stage.h"

#include <cstdlib>
#include <fstream>

namespace helio::test {
namespace {

/// The value; an error throws, and so fails the test.
template <typename T>
T orThrow(Result<T> result) {
  if (!result) throw std::runtime_error(result.error().message);
  return std::move(*result);
}

}  // namespace

render::Renderer& renderer() {
  static const std::unique_ptr<render::Renderer> instance = [] {
    render::RendererOptions options;
    options.device = std::getenv("HELIOGRAPH_DEVICE") ? "" : "cpu";
    options.strict_validation =
        std::getenv("HELIOGRAPH_TEST_WITHOUT_VALIDATION") == nullptr;  // the bundle has no layers
    options.strict_numerics = true;
    return orThrow(render::makeRenderer(options));
  }();
  return *instance;
}

Stage::Stage(scene::ScenePtr scene) : viewed_(orThrow(ViewedWorld::open(renderer(), std::move(scene)))) {}

void Stage::setCulling(render::Culling culling, const render::CullingSettings& settings) {
  if (auto set = renderer().setCulling(viewed_->handle(), culling, settings); !set)
    throw std::runtime_error(set.error().message);
}

render::Frame Stage::tick(const scene::Camera& camera, const render::ViewSettings& settings) {
  return orThrow(viewed_->tick(camera, settings, step_));
}

render::Frame Stage::accumulate(const scene::Camera& camera, const render::ViewSettings& settings, uint32_t count) {
  render::Frame frame;
  for (uint32_t i = 0; i < count; ++i) frame = tick(camera, settings);
  return frame;
}

void Stage::edit(const std::vector<world::Edit>& edits) {
  auto batch = world().resolve(edits);
  ASSERT_TRUE(batch.ok()) << batch.error().message;
  ASSERT_TRUE(world().apply(world().seq() + 1, *batch).ok());
}

glm::vec3 texel(const render::Frame& frame, uint32_t x, uint32_t y) {
  const float* t = &frame.radiance.at(3 * (size_t{y} * frame.pixels->width + x));
  return {t[0], t[1], t[2]};
}

glm::vec3 mean(const render::Frame& frame) {
  glm::dvec3 sum(0.0);
  for (size_t i = 0; i + 2 < frame.radiance.size(); i += 3)
    sum += glm::dvec3(frame.radiance[i], frame.radiance[i + 1], frame.radiance[i + 2]);
  return glm::vec3(sum / static_cast<double>(frame.radiance.size() / 3));
}

std::vector<uint8_t> bytes(const render::Frame& frame) {
  const size_t size = size_t{4} * frame.pixels->width * frame.pixels->height;
  return {frame.pixels->rgbx, frame.pixels->rgbx + size};
}

bool recorded(const render::Frame& frame, const std::string& pass) {
  for (const render::PassTime& p : frame.stats.passes)
    if (p.name == pass) return true;
  return false;
}

void showPicture(const render::Frame& frame, const std::string& name) {
  const char* folder = std::getenv("HELIOGRAPH_TEST_PICTURES");
  if (!folder || !frame.pixels) return;
  std::ofstream file(std::string(folder) + "/" + name + ".ppm", std::ios::binary);
  file << "P6 " << frame.pixels->width << " " << frame.pixels->height << " 255\n";
  const std::vector<uint8_t> rgbx = bytes(frame);
  for (size_t i = 0; i < rgbx.size(); i += 4) file.write(reinterpret_cast<const char*>(&rgbx[i]), 3);
}

}  // namespace helio::test
