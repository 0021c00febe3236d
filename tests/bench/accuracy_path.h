// How the camera comes to where `helio-bench accuracy` looks from, and what changes along its way.
#pragma once

#include <cstdint>
#include <vector>

#include "bench/accuracy.h"

namespace helio::bench {

/// Where the camera is `ticks` before the last frame of a run: for fly to the side of `end`, else there already.
scene::Camera cameraBefore(const scene::Camera& end, MotionKind motion, uint32_t ticks);
/// Where the camera was before a jump: 40 m off, turned to the side.
scene::Camera cameraElsewhere(const scene::Camera& end);
/// Ticks there before a run.
constexpr uint32_t kTicksElsewhere = 16;

/// From each pixel of a run's last frame to where its surface was in the frame before, pixels to the right and down.
using MotionField = std::vector<glm::vec2>;
/// Errors: the renderer's.
Result<MotionField> motionOfLastFrame(render::Renderer& renderer, const scene::ScenePtr& scene,
                                      const scene::NamedCamera& camera, const AccuracyOptions& options);

/// Mean change of displayed luma, [0, 1], from `before` to `now` along the motion, over pixels whose surface was in the
/// picture; RGBA, 4 bytes a pixel. What comes from behind something counts as change.
double meanChange(const std::vector<uint8_t>& before, const std::vector<uint8_t>& now, const MotionField& motion,
                  uint32_t width, uint32_t height);

}  // namespace helio::bench
