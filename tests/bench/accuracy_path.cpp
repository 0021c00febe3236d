#include "bench/accuracy_path.h"

#include <algorithm>
#include <cmath>

#include "render/camera_frame.h"
#include "support/viewed_world.h"

namespace helio::bench {
namespace {

constexpr float kFlightStep = 0.02f;  // metres a tick, sideways: a walk at 60 frames a second
constexpr float kJump = 40.0f;        // metres

}  // namespace

scene::Camera cameraBefore(const scene::Camera& end, MotionKind motion, uint32_t ticks) {
  scene::Camera camera = end;
  if (motion == MotionKind::fly)
    camera.position += static_cast<float>(ticks) * kFlightStep * render::cameraFrame(end).right;
  return camera;
}

scene::Camera cameraElsewhere(const scene::Camera& end) {
  const render::CameraFrame frame = render::cameraFrame(end);
  return {end.position + kJump * frame.right, frame.right, end.up, end.vfov};
}

Result<MotionField> motionOfLastFrame(render::Renderer& renderer, const scene::ScenePtr& scene,
                                      const scene::NamedCamera& camera, const AccuracyOptions& options) {
  MotionField motion(size_t{options.width} * options.height, glm::vec2(0.0f));
  if (options.motion != MotionKind::fly) return motion;
  auto viewed = test::ViewedWorld::open(renderer, scene);
  if (!viewed) return viewed.error();
  render::ViewSettings settings = baseSettings(options.width, options.height);
  settings.inspect = render::Inspect::motion;
  settings.bounces = 0;
  for (const uint32_t left : {1u, 0u}) {
    auto shown = (*viewed)->tick(cameraBefore(camera.camera, options.motion, left), settings, 0.0);
    if (!shown) return shown.error();
    for (size_t i = 0; i < motion.size(); ++i) motion[i] = {shown->radiance[3 * i], shown->radiance[3 * i + 1]};
  }
  return motion;
}

double meanChange(const std::vector<uint8_t>& before, const std::vector<uint8_t>& now, const MotionField& motion,
                  uint32_t width, uint32_t height) {
  double sum = 0.0;
  size_t pixels = 0;
  const auto lumaBefore = [&](uint32_t x, uint32_t y) { return luma(&before[4 * (size_t{y} * width + x)]); };
  for (uint32_t y = 0; y < height; ++y)
    for (uint32_t x = 0; x < width; ++x) {
      const size_t i = size_t{y} * width + x;
      const glm::vec2 at = glm::vec2(x, y) + motion[i];
      if (!(at.x >= 0.0f && at.y >= 0.0f && at.x <= static_cast<float>(width - 1) &&
            at.y <= static_cast<float>(height - 1)))
        continue;
      const auto left = static_cast<uint32_t>(at.x), top = static_cast<uint32_t>(at.y);
      const uint32_t right = std::min(left + 1, width - 1), bottom = std::min(top + 1, height - 1);
      const auto fx = static_cast<double>(at.x) - left, fy = static_cast<double>(at.y) - top;
      const double was = (1.0 - fy) * ((1.0 - fx) * lumaBefore(left, top) + fx * lumaBefore(right, top)) +
                         fy * ((1.0 - fx) * lumaBefore(left, bottom) + fx * lumaBefore(right, bottom));
      sum += std::abs(luma(&now[4 * i]) - was);
      ++pixels;
    }
  return pixels > 0 ? sum / static_cast<double>(pixels) : 0.0;
}

}  // namespace helio::bench
