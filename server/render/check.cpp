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

/// Further paths join the only sample of the tick, and what denoisers know of it.
Result<void> checkExtraSamples(const ViewSettings& settings) {
  if (auto r = inRange("settings.extra_samples", settings.extra_samples, 0.0f, 4.0f); !r) return r;
  if (settings.extra_samples == 0.0f || settings.mode == Mode::reference) return {};
  const std::string value = std::to_string(settings.extra_samples), extra = "settings.extra_samples is " + value + ", ";
  if (settings.denoiser == Denoiser::none && settings.inspect != Inspect::unfiltered)
    return invalid("settings.extra_samples", value,
                   extra + "and only a denoiser has a use for it: choose one, or give extra_samples 0");
  if (settings.samples != 1)
    return invalid("settings.samples", std::to_string(settings.samples),
                   extra + "and spends by need what samples spend everywhere: choose 1 sample a tick");
  if (settings.indirect_rate != IndirectRate::full)
    return invalid("settings.indirect_rate", {}, extra + "and further paths are whole ones: choose full");
  return {};
}

/// Whitted's technique takes nothing that is found by chance.
Result<void> checkWhitted(const ViewSettings& settings) {
  const std::string whitted = "settings.technique is whitted, which has no random numbers: ";
  if (settings.denoiser != Denoiser::none || settings.inspect == Inspect::unfiltered)
    return invalid("settings.denoiser", {}, whitted + "there is no noise to filter; choose denoiser none");
  if (settings.aperture > 0.0f)
    return invalid("settings.aperture", std::to_string(settings.aperture), whitted + "give aperture 0");
  if (settings.ambient == Ambient::occluded)
    return invalid("settings.ambient", "occluded", whitted + "choose ambient constant or none");
  if (settings.light_feedback) return invalid("settings.light_feedback", "true", whitted + "turn light_feedback off");
  return {};
}

Result<void> checkTechnique(const ViewSettings& settings) {
  if (auto r = inRange("settings.ambient_radius", settings.ambient_radius, 1e-6f, 1e6f); !r) return r;
  if (auto r = inRange("settings.aperture", settings.aperture, 0.0f, 10.0f); !r) return r;
  if (auto r = inRange("settings.focus", settings.focus, 0.01f, 1e6f); !r) return r;
  if (settings.aperture > 0.0f && settings.mode == Mode::hybrid && settings.primary == Primary::raster)
    return invalid("settings.aperture", std::to_string(settings.aperture),
                   "settings.aperture is " + std::to_string(settings.aperture) +
                       ": a rasteriser sees from one point; choose primary traced, or aperture 0");
  if (settings.light_feedback && !settings.light_lists)
    return invalid("settings.light_feedback", "true",
                   "settings.light_feedback is about light lists, and settings.light_lists is off: turn it on");
  if (settings.mode == Mode::reference) return {};
  if (settings.indirect_rate != IndirectRate::full) {
    const std::string rate = "settings.indirect_rate is not full, ";
    if (settings.technique != Technique::path_traced)
      return invalid("settings.indirect_rate", {},
                     rate + "and only path tracing has indirect light: choose it, or full");
    if (settings.samples != 1)
      return invalid("settings.samples", std::to_string(settings.samples), rate + "so choose 1 sample a tick");
    if (settings.denoiser == Denoiser::asvgf)
      return invalid("settings.denoiser", "asvgf",
                     rate + "and asvgf compares single samples with themselves: choose another denoiser");
    if (settings.measure_bare_trace)
      return invalid("settings.measure_bare_trace", "true", rate + "and rays are logged for full alone");
  }
  if (settings.technique == Technique::path_traced) {
    if (settings.ambient != Ambient::none)
      return invalid("settings.ambient", {},
                     "settings.ambient stands in for light that path tracing follows: choose technique distributed or "
                     "whitted, or ambient none");
    return {};
  }
  if (!settings.light_sampling)
    return invalid("settings.light_sampling", "false",
                   "settings.light_sampling is off, and settings.technique lives on it: turn it on");
  if (settings.sky_sampling && settings.ambient != Ambient::none)
    return invalid("settings.sky_sampling", "true",
                   "settings.sky_sampling and settings.ambient both bring the sky's light: choose one of them");
  if (settings.measure_bare_trace)
    return invalid("settings.measure_bare_trace", "true",
                   "settings.measure_bare_trace logs the rays of path tracing alone: choose technique path_traced");
  return settings.technique == Technique::whitted ? checkWhitted(settings) : Result<void>{};
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
  if (auto r = checkTechnique(settings); !r) return r;
  if (auto r = checkExtraSamples(settings); !r) return r;
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
  if (auto r = inRange("culling.smoothing", lipac.smoothing, 1u, 64u); !r) return r;
  if (auto r = inRange("culling.counted_paths", lipac.counted_paths, 1024u, 16'777'216u); !r) return r;
  if (auto r = inRange("culling.builds", settings.builds, 1u, 1'000'000u); !r) return r;
  if (auto r = inRange("culling.shared_blases.age_limit", settings.shared_blases.age_limit, 1u, 1'000'000u); !r)
    return r;
  return inRange("culling.radius", settings.radius, 0.001f, 1e6f);
}

}  // namespace helio::render
