#include <cmath>
#include <string>

#include "render/renderer.h"

namespace helio::render {
namespace {

constexpr float kMaxCoordinate = 1e6f;  // metres

bool finite(const glm::vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

std::string text(const glm::vec3& v) {
  return "(" + std::to_string(v.x) + ", " + std::to_string(v.y) + ", " + std::to_string(v.z) + ")";
}

template <typename T>
Result<void> inRange(const char* field, T value, T low, T high) {
  if (value >= low && value <= high) return {};
  const std::string limit = std::to_string(low) + " to " + std::to_string(high);
  return Error{ErrorKind::invalid, std::string(field) + " is " + std::to_string(value) + ": give " + limit, field,
               std::to_string(value), limit};
}

}  // namespace

Result<void> check(const scene::Camera& camera) {
  if (!finite(camera.position) || glm::length(camera.position) > kMaxCoordinate)
    return invalid("camera.position", text(camera.position),
                   "camera.position is " + text(camera.position) + ": give finite metres, at most 1000 km away");
  if (!finite(camera.forward) || !finite(camera.up) || !(glm::length(camera.forward) > 1e-6f) ||
      !(glm::length(camera.up) > 1e-6f))
    return invalid("camera.forward", text(camera.forward), "camera.forward and camera.up must be finite and not zero");
  if (glm::length(glm::cross(glm::normalize(camera.forward), glm::normalize(camera.up))) < 1e-4f)
    return invalid("camera.up", text(camera.up), "camera.up is parallel to camera.forward: give another direction");
  if (!(camera.vfov > 0.001f && camera.vfov < 3.1f))
    return invalid("camera.vfov", std::to_string(camera.vfov),
                   "camera.vfov is " + std::to_string(camera.vfov) + ": give 0.001 to 3.1 radians");
  return {};
}

Result<void> check(const ViewSettings& settings) {
  if (auto r = inRange("settings.width", settings.width, 16u, 8192u); !r) return r;
  if (auto r = inRange("settings.height", settings.height, 16u, 8192u); !r) return r;
  if (auto r = inRange("settings.bounces", settings.bounces, 0u, 32u); !r) return r;
  if (auto r = inRange("settings.samples", settings.samples, 1u, 64u); !r) return r;
  if (auto r = inRange("settings.lamp_samples", settings.lamp_samples, 0u, 64u); !r) return r;
  if (settings.measure_bare_trace && settings.lamp_samples != 1)
    return invalid("settings.lamp_samples", std::to_string(settings.lamp_samples),
                   "settings.lamp_samples is " + std::to_string(settings.lamp_samples) +
                       ": rays can be traced again without shading for 1 alone");
  if (auto r = inRange("settings.regularisation", settings.regularisation, 0.0f, 1.0f); !r) return r;
  if (auto r = inRange("settings.shadow_map_size", settings.shadow_map_size, 256u, 4096u); !r) return r;
  if (settings.culling_view != CullingView::none && settings.mode == Mode::reference)
    return invalid("settings.culling_view", std::to_string(static_cast<uint32_t>(settings.culling_view)),
                   "settings.culling_view shows what culling does, and reference mode knows none: choose hybrid");
  if (settings.inspect >= Inspect::diffuse && settings.denoiser == Denoiser::none)
    return invalid("settings.inspect", std::to_string(static_cast<uint32_t>(settings.inspect)),
                   "settings.inspect asks for what a denoiser has, and settings.denoiser is none: choose a denoiser");
  return inRange("settings.exposure_ev", settings.exposure_ev, -16.0f, 16.0f);
}

Result<void> check(const CullingSettings& settings) {
  using accel::LipacSettings;
  const LipacSettings& lipac = settings.lipac;
  const std::pair<const char*, float> thresholds[] = {{"culling.box_activate", lipac.box_activate},
                                                      {"culling.box_deactivate", lipac.box_deactivate},
                                                      {"culling.own_activate", lipac.own_activate},
                                                      {"culling.own_deactivate", lipac.own_deactivate}};
  for (const auto& [field, hits] : thresholds)
    if (hits != LipacSettings::kUnreachable)
      if (auto r = inRange(field, hits, 2.0f, LipacSettings::kHighestThreshold); !r) return r;
  if (auto r = inRange("culling.frames_above", lipac.frames_above, 1u, 7u); !r) return r;
  if (auto r = inRange("culling.frames_below", lipac.frames_below, 1u, 15u); !r) return r;
  if (auto r = inRange("culling.sight_radius", lipac.sight_radius, 0.0f, 1e6f); !r) return r;
  if (auto r = inRange("culling.sight_blocks", lipac.sight_blocks, 1u, 1'000'000u); !r) return r;
  if (auto r = inRange("culling.counted_paths", lipac.counted_paths, 1024u, 16'777'216u); !r) return r;
  if (auto r = inRange("culling.builds", settings.builds, 1u, 1'000'000u); !r) return r;
  if (auto r = inRange("culling.shared_blases.age_limit", settings.shared_blases.age_limit, 1u, 1'000'000u); !r)
    return r;
  return inRange("culling.radius", settings.radius, 0.001f, 1e6f);
}

}  // namespace helio::render
