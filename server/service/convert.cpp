#include "service/convert.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <numbers>
#include <sstream>
#include <utility>

#include <google/protobuf/generated_enum_reflection.h>
#include <spdlog/fmt/fmt.h>
#include <glm/gtc/quaternion.hpp>

#include "render/choices.h"
#include "render/light_switches.h"
#include "scene/city.h"

namespace helio::service {
namespace {

template <typename T>
std::string text(T number) {
  std::ostringstream out;
  out << number;
  return out.str();
}

std::string range(uint32_t low, uint32_t high) { return fmt::format("[{}, {}]", low, high); }

Outcome<void> within(const std::string& field, uint32_t value, uint32_t low, uint32_t high) {
  if (value < low || value > high) return outOfRange(field, text(value), range(low, high));
  return {};
}

/// The renderer's error about its own struct, under the sender's name of the message: "camera.vfov" is
/// "hello.camera.vfov".
Failure inside(const std::string& message, Error error) {
  error.field = message + error.field.substr(std::min(error.field.find('.'), error.field.size()));
  return error;
}

const google::protobuf::FieldDescriptor* fieldOf(const render::LightSwitch& light_switch) {
  return v1::LightTransport::descriptor()->FindFieldByName(light_switch.name);
}

/// The wire's name of a choice: "rays_and_map" is SUN_SHADOW_RAYS_AND_MAP, with the beginning that the enumeration's
/// value 0 has.
std::string wireName(const google::protobuf::EnumDescriptor& wire, std::string name) {
  const auto& unspecified = wire.FindValueByNumber(0)->name();
  for (char& c : name) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return unspecified.substr(0, unspecified.rfind('_') + 1) + name;
}

/// Takes over what was chosen; UNSPECIFIED leaves the default.
template <typename Wire, typename Value, size_t N>
Outcome<void> choose(const std::string& field, Wire number, const render::Choice<Value> (&choices)[N], Value& chosen) {
  if (number == 0) return {};
  const auto& wire = *google::protobuf::GetEnumDescriptor<Wire>();
  if (const auto* value = wire.FindValueByNumber(number))
    for (const auto& choice : choices)
      if (value->name() == wireName(wire, choice.name)) {
        chosen = choice.value;
        return {};
      }
  return outOfRange(field, text(int(number)), wire.name());
}

/// The wire's number of what is in effect.
template <typename Wire, typename Value, size_t N>
Wire numberOf(const render::Choice<Value> (&choices)[N], Value chosen) {
  const auto& wire = *google::protobuf::GetEnumDescriptor<Wire>();
  for (const auto& choice : choices)
    if (choice.value == chosen)
      if (const auto* value = wire.FindValueByName(wireName(wire, choice.name)))
        return static_cast<Wire>(value->number());
  return static_cast<Wire>(0);  // what the wire calls UNSPECIFIED: nothing was chosen
}

/// What settings and shots have in common.
template <typename Message>
Outcome<render::ViewSettings> viewSettings(const Message& message, const std::string& name, const Limits& limits) {
  render::ViewSettings view;
  if (auto ok = within(name + ".width", message.width(), limits.min_size, limits.max_size); !ok) return ok.error();
  if (auto ok = within(name + ".height", message.height(), limits.min_size, limits.max_size); !ok) return ok.error();
  view.width = message.width();
  view.height = message.height();
  if (auto ok = choose(name + ".mode", message.mode(), render::kModes, view.mode); !ok) return ok.error();
  if (auto ok = choose(name + ".primary", message.primary(), render::kPrimaries, view.primary); !ok) return ok.error();
  switch (message.exposure().mode()) {
    case v1::EXPOSURE_MODE_UNSPECIFIED:
    case v1::EXPOSURE_MODE_AUTOMATIC:
      view.auto_exposure = true;
      break;
    case v1::EXPOSURE_MODE_FIXED:
      view.auto_exposure = false;
      break;
    default:
      return outOfRange(name + ".exposure.mode", text(int(message.exposure().mode())), "ExposureMode");
  }
  view.exposure_ev = message.exposure().ev();
  // Both enumerations have the same numbers.
  static_assert(v1::MATERIAL_OVERRIDE_MATERIALS == static_cast<int>(render::MaterialOverride::materials) &&
                v1::MaterialOverride_ARRAYSIZE == shared::kMaterialOverrides);
  if (!v1::MaterialOverride_IsValid(message.materials()))
    return outOfRange(name + ".materials", text(int(message.materials())), "MaterialOverride");
  view.materials = static_cast<render::MaterialOverride>(message.materials());
  if (message.has_bounces()) view.bounces = message.bounces();
  const v1::Approximations& approximations = message.approximations();
  if (auto ok = choose(name + ".approximations.sun_shadow", approximations.sun_shadow(), render::kSunShadows,
                       view.sun_shadow);
      !ok)
    return ok.error();
  if (approximations.shadow_map_size() != 0) view.shadow_map_size = approximations.shadow_map_size();
  view.taa = approximations.taa();
  view.extra_samples = approximations.extra_samples();
  if (approximations.has_levels_of_detail()) view.levels_of_detail = approximations.levels_of_detail();
  if (auto ok = choose(name + ".approximations.denoiser", approximations.denoiser(), render::kDenoisers, view.denoiser);
      !ok)
    return ok.error();
  if (auto ok = choose(name + ".inspect", message.inspect(), render::kInspects, view.inspect); !ok) return ok.error();
  if (auto ok = choose(name + ".culling_view", message.culling_view(), render::kCullingViews, view.culling_view); !ok)
    return ok.error();
  const v1::LightTransport& light = message.light_transport();
  for (const render::LightSwitch& each : render::kLightSwitches)
    if (const auto* field = fieldOf(each); light.GetReflection()->HasField(light, field))
      view.*each.field = light.GetReflection()->GetBool(light, field);
  if (auto ok =
          choose(name + ".approximations.technique", approximations.technique(), render::kTechniques, view.technique);
      !ok)
    return ok.error();
  if (auto ok = choose(name + ".approximations.ambient", approximations.ambient(), render::kAmbients, view.ambient);
      !ok)
    return ok.error();
  if (approximations.ambient_radius() != 0.0f) view.ambient_radius = approximations.ambient_radius();
  if (auto ok = choose(name + ".approximations.indirect_rate", approximations.indirect_rate(), render::kIndirectRates,
                       view.indirect_rate);
      !ok)
    return ok.error();
  if (auto ok = choose(name + ".approximations.reconstruction", approximations.reconstruction(),
                       render::kReconstructions, view.reconstruction);
      !ok)
    return ok.error();
  view.aperture = message.lens().aperture();
  if (message.lens().focus() != 0.0f) view.focus = message.lens().focus();
  view.regularisation = light.regularisation();
  if (light.has_lamp_samples()) view.lamp_samples = light.lamp_samples();
  return view;
}

Outcome<world::Pose> placement(const google::protobuf::RepeatedField<float>& numbers, int first) {
  world::Pose pose;
  pose.position = {numbers[first], numbers[first + 1], numbers[first + 2]};
  pose.rotation = glm::quat(numbers[first + 6], numbers[first + 3], numbers[first + 4], numbers[first + 5]);
  pose.scale = numbers[first + 7];
  return pose;
}

constexpr int kPlacementNumbers = 8;

Outcome<world::Edit> build(const v1::Build& message, const std::string& field) {
  const auto& numbers = message.placements();
  if (numbers.empty() || numbers.size() % kPlacementNumbers != 0)
    return outOfRange(field + ".placements", text(numbers.size()) + " numbers", "multiples of 8 above 0");
  world::Build edit{message.prefab(), {}};
  edit.poses.reserve(size_t(numbers.size() / kPlacementNumbers));
  for (int first = 0; first < numbers.size(); first += kPlacementNumbers)
    edit.poses.push_back(*placement(numbers, first));
  return world::Edit{std::move(edit)};
}

Outcome<world::Edit> setSun(const v1::SetSun& message, const std::string& field) {
  switch (message.kind_case()) {
    case v1::SetSun::kDaylight: {
      const auto& daylight = message.daylight();
      constexpr float kQuarterTurn = std::numbers::pi_v<float> / 2;
      if (!(std::abs(daylight.elevation()) <= kQuarterTurn))
        return outOfRange(field + ".daylight.elevation", text(daylight.elevation()), "[-pi/2, pi/2]");
      if (!std::isfinite(daylight.azimuth()))
        return outOfRange(field + ".daylight.azimuth", text(daylight.azimuth()), "finite numbers");
      return world::Edit{world::SetSun{scene::daylight(daylight.elevation(), daylight.azimuth()).sun, true}};
    }
    case v1::SetSun::kSun: {
      const auto& sun = message.sun();
      const auto vec = [](const v1::Vec3& v) { return glm::vec3(v.x(), v.y(), v.z()); };
      return world::Edit{world::SetSun{{vec(sun.direction()), vec(sun.irradiance()), sun.angular_diameter()}, false}};
    }
    case v1::SetSun::KIND_NOT_SET:
      break;
  }
  return outOfRange(field, "neither daylight nor sun", "SetSun");
}

Outcome<world::Edit> edit(const v1::Edit& message, const std::string& name) {
  switch (message.kind_case()) {
    case v1::Edit::kBuild:
      return build(message.build(), name + ".build");
    case v1::Edit::kDestroy:
      return world::Edit{world::Destroy{{message.destroy().ids().begin(), message.destroy().ids().end()}}};
    case v1::Edit::kDestroyRegion: {
      const auto& region = message.destroy_region();
      return world::Edit{world::DestroyRegion{{region.x(), region.z()}, region.radius()}};
    }
    case v1::Edit::kMove: {
      const auto& numbers = message.move().placement();
      if (numbers.size() != kPlacementNumbers)
        return outOfRange(name + ".move.placement", text(numbers.size()) + " numbers", "8 numbers");
      return world::Edit{world::Move{message.move().id(), *placement(numbers, 0)}};
    }
    case v1::Edit::kSetSun:
      return setSun(message.set_sun(), name + ".set_sun");
    case v1::Edit::kSetTime: {
      const auto& time = message.set_time();
      world::SetTime set;
      if (time.has_paused()) set.paused = time.paused();
      if (time.has_rate()) set.rate = time.rate();
      if (time.has_seek()) set.seek = time.seek();
      return world::Edit{set};
    }
    case v1::Edit::KIND_NOT_SET:
      break;
  }
  // Perhaps a newer client's kind of edit: never acknowledge what is not done.
  return outOfRange(name, "of no kind that this server knows",
                    "build, destroy, destroy_region, move, set_sun, set_time");
}

v1::Vec3 vec(const glm::vec3& v) {
  v1::Vec3 out;
  out.set_x(v.x);
  out.set_y(v.y);
  out.set_z(v.z);
  return out;
}

}  // namespace

namespace {

Outcome<render::Goal> goalOf(const v1::Settings& message, const render::ViewSettings& view) {
  render::Goal goal;
  switch (message.goal().kind_case()) {
    case v1::Goal::kMaxFrameMs:
      goal = {render::Goal::Kind::max_frame_ms, static_cast<double>(message.goal().max_frame_ms())};
      break;
    case v1::Goal::kMaxError:
      goal = {render::Goal::Kind::max_error, static_cast<double>(message.goal().max_error())};
      break;
    case v1::Goal::KIND_NOT_SET:
      return outOfRange("settings.goal", "of no kind that this server knows", "max_frame_ms, max_error");
  }
  if (auto ok = render::check(goal); !ok) return inside("settings.goal", ok.error());
  if (view.mode != render::Mode::hybrid)
    return outOfRange("settings.goal", "with mode reference", "goals of mode hybrid");
  // The ladder's rungs change samples and denoiser, which not every technique bears, and its prices are path tracing's.
  if (view.technique != render::Technique::path_traced || view.indirect_rate != render::IndirectRate::full)
    return outOfRange("settings.goal", "with a technique or an indirect rate of its own",
                      "goals with technique path_traced and indirect_rate full");
  return goal;
}

}  // namespace

Outcome<ViewerSettings> fromWire(const v1::Settings& message, const Limits& limits) {
  ViewerSettings settings;
  auto view = viewSettings(message, "settings", limits);
  if (!view) return view.error();
  settings.view = *view;
  if (message.samples() != 0) settings.view.samples = message.samples();
  if (message.has_goal()) {
    auto goal = goalOf(message, settings.view);
    if (!goal) return goal.error();
    settings.goal = *goal;
  }
  const auto& stream = message.stream();
  if (stream.max_fps() != 0) settings.max_fps = stream.max_fps();
  if (stream.max_latency_ms() != 0) settings.max_latency_ms = stream.max_latency_ms();
  if (stream.jpeg_quality() > 100)
    return outOfRange("settings.stream.jpeg_quality", text(stream.jpeg_quality()), "[1, 100]");
  if (stream.jpeg_quality() != 0) settings.jpeg_quality = int(stream.jpeg_quality());
  if (stream.still_quality() > 100)
    return outOfRange("settings.stream.still_quality", text(stream.still_quality()), "[1, 100]");
  settings.still_quality =
      stream.still_quality() != 0 ? int(stream.still_quality()) : std::max(95, settings.jpeg_quality);
  settings.max_kbps = stream.max_kbps();
  if (auto ok = within("settings.stream.max_fps", settings.max_fps, 1, limits.max_fps); !ok) return ok.error();
  if (auto ok = within("settings.stream.max_latency_ms", settings.max_latency_ms, 10, 60'000); !ok) return ok.error();
  settings.paused = message.paused();
  settings.revision = message.revision();
  if (auto ok = render::check(settings.view); !ok) return inside("settings", ok.error());
  return settings;
}

v1::Settings toWire(const ViewerSettings& settings) {
  const auto& view = settings.view;
  v1::Settings out;
  out.set_revision(settings.revision);
  out.set_width(view.width);
  out.set_height(view.height);
  out.set_mode(numberOf<v1::RenderMode>(render::kModes, view.mode));
  out.set_primary(numberOf<v1::PrimaryHits>(render::kPrimaries, view.primary));
  out.set_bounces(view.bounces);
  out.set_samples(view.samples);
  out.mutable_exposure()->set_mode(view.auto_exposure ? v1::EXPOSURE_MODE_AUTOMATIC : v1::EXPOSURE_MODE_FIXED);
  out.mutable_exposure()->set_ev(view.exposure_ev);
  out.mutable_stream()->set_max_fps(settings.max_fps);
  out.mutable_stream()->set_max_latency_ms(settings.max_latency_ms);
  out.mutable_stream()->set_jpeg_quality(uint32_t(settings.jpeg_quality));
  out.mutable_stream()->set_still_quality(uint32_t(settings.still_quality));
  out.mutable_stream()->set_max_kbps(settings.max_kbps);
  out.set_paused(settings.paused);
  if (settings.goal) {
    const auto value = static_cast<float>(settings.goal->value);
    if (settings.goal->kind == render::Goal::Kind::max_frame_ms) out.mutable_goal()->set_max_frame_ms(value);
    else out.mutable_goal()->set_max_error(value);
  }
  out.set_materials(static_cast<v1::MaterialOverride>(view.materials));
  v1::Approximations& approximations = *out.mutable_approximations();
  approximations.set_sun_shadow(numberOf<v1::SunShadow>(render::kSunShadows, view.sun_shadow));
  approximations.set_shadow_map_size(view.shadow_map_size);
  approximations.set_levels_of_detail(view.levels_of_detail);
  approximations.set_taa(view.taa);
  approximations.set_extra_samples(view.extra_samples);
  approximations.set_denoiser(numberOf<v1::Denoiser>(render::kDenoisers, view.denoiser));
  approximations.set_technique(numberOf<v1::Technique>(render::kTechniques, view.technique));
  approximations.set_ambient(numberOf<v1::Ambient>(render::kAmbients, view.ambient));
  approximations.set_ambient_radius(view.ambient_radius);
  approximations.set_indirect_rate(numberOf<v1::IndirectRate>(render::kIndirectRates, view.indirect_rate));
  approximations.set_reconstruction(numberOf<v1::Reconstruction>(render::kReconstructions, view.reconstruction));
  out.mutable_lens()->set_aperture(view.aperture);
  out.mutable_lens()->set_focus(view.focus);
  out.set_culling_view(numberOf<v1::CullingView>(render::kCullingViews, view.culling_view));
  out.set_inspect(numberOf<v1::Inspect>(render::kInspects, view.inspect));
  v1::LightTransport& light = *out.mutable_light_transport();
  for (const render::LightSwitch& each : render::kLightSwitches)
    light.GetReflection()->SetBool(&light, fieldOf(each), view.*each.field);
  light.set_regularisation(view.regularisation);
  light.set_lamp_samples(view.lamp_samples);
  return out;
}

Outcome<scene::Camera> fromWire(const v1::Camera& message, const std::string& field, const Limits& limits) {
  const auto& pose = message.pose();
  if (pose.size() != 7) return outOfRange(field + ".pose", text(pose.size()) + " numbers", "7 numbers");
  for (int i = 0; i < pose.size(); ++i)
    if (!std::isfinite(pose[i]))
      return outOfRange(field + ".pose", text(pose[i]) + " at index " + text(i), "finite numbers");
  scene::Camera camera;
  camera.position = {pose[0], pose[1], pose[2]};
  const float reach = limits.world.max_coordinate;
  for (int i = 0; i < 3; ++i)
    if (std::abs(pose[i]) > reach)
      return outOfRange(field + ".pose", fmt::format("{} at index {}", pose[i], i), fmt::format("[-{0}, {0}]", reach));
  const glm::quat rotation(pose[6], pose[3], pose[4], pose[5]);
  const float length = glm::length(rotation);
  if (!(length > 1e-6f && std::isfinite(length)))
    return outOfRange(field + ".pose", "a rotation of length " + text(length), "lengths above 1e-6");
  const glm::quat unit = rotation / length;
  camera.forward = unit * glm::vec3(0, 0, -1);
  camera.up = unit * glm::vec3(0, 1, 0);
  camera.vfov = message.vfov();
  if (auto ok = render::check(camera); !ok) return inside(field, ok.error());
  return camera;
}

v1::Camera toWire(const scene::Camera& camera) {
  const glm::vec3 forward = glm::normalize(camera.forward);
  // Straight up or down with the usual `up` has no roll of its own: take one.
  const bool parallel = glm::length(glm::cross(forward, camera.up)) < 1e-4f * glm::length(camera.up);
  const glm::vec3 up = parallel ? (std::abs(forward.y) > 0.5f ? glm::vec3(0, 0, -1) : glm::vec3(0, 1, 0)) : camera.up;
  const glm::quat rotation = glm::quatLookAtRH(forward, glm::normalize(up));
  v1::Camera out;
  for (const float number :
       {camera.position.x, camera.position.y, camera.position.z, rotation.x, rotation.y, rotation.z, rotation.w})
    out.add_pose(number);
  out.set_vfov(camera.vfov);
  return out;
}

Outcome<ShotSettings> fromWire(const v1::RenderRequest& message, const Limits& limits) {
  ShotSettings shot;
  auto view = viewSettings(message, "request", limits);
  if (!view) return view.error();
  shot.view = *view;
  if (message.samples() != 0) shot.samples = message.samples();
  if (auto ok = within("request.samples", shot.samples, 1, limits.max_shot_samples); !ok) return ok.error();
  switch (message.codec()) {
    case v1::CODEC_UNSPECIFIED:
      break;
    case v1::CODEC_JPEG:
    case v1::CODEC_PNG:
    case v1::CODEC_PFM:
      shot.codec = message.codec();
      break;
    default:
      return outOfRange("request.codec", text(int(message.codec())), "Codec");
  }
  shot.view.keep_radiance = shot.codec == v1::CODEC_PFM;
  if (message.jpeg_quality() > 100) return outOfRange("request.jpeg_quality", text(message.jpeg_quality()), "[1, 100]");
  if (message.jpeg_quality() != 0) shot.jpeg_quality = int(message.jpeg_quality());
  if (auto ok = render::check(shot.view); !ok) return inside("request", ok.error());
  return shot;
}

Outcome<std::vector<world::Edit>> fromWire(const google::protobuf::RepeatedPtrField<v1::Edit>& messages,
                                           const Limits& limits) {
  const uint32_t most = limits.world.max_edits_per_batch;
  if (messages.empty()) return outOfRange("edits", "empty", range(1, most) + " edits");
  if (uint32_t(messages.size()) > most)
    return beyondLimit("edits", text(messages.size()) + " edits", text(most),
                       text(messages.size()) + " edits are more than the " + text(most) + " of one call; send several");
  std::vector<world::Edit> edits;
  edits.reserve(size_t(messages.size()));
  for (int i = 0; i < messages.size(); ++i) {
    auto converted = edit(messages[i], "edits[" + text(i) + "]");
    if (!converted) return converted.error();
    edits.push_back(std::move(*converted));
  }
  return edits;
}

v1::Bounds toWire(const scene::Aabb& box) {
  v1::Bounds out;
  if (box.empty()) return out;
  *out.mutable_min() = vec(box.min);
  *out.mutable_max() = vec(box.max);
  return out;
}

v1::Sun toWire(const scene::Sun& sun) {
  v1::Sun out;
  *out.mutable_direction() = vec(sun.direction);
  *out.mutable_irradiance() = vec(sun.irradiance);
  out.set_angular_diameter(sun.angular_diameter);
  return out;
}

v1::RayCounts toWire(const render::Rays& rays) {
  v1::RayCounts out;
  out.set_primary(rays.primary);
  out.set_bounce(rays.bounce);
  out.set_shadow(rays.shadow);
  out.set_retrace(rays.retrace);
  return out;
}

v1::AccelerationUse toWire(const render::AccelerationUse& use, const std::optional<accel::LipacFigures>& culling) {
  v1::AccelerationUse out;
  out.set_own_blases(use.own_blases);
  out.set_own_blases_waiting(use.own_blases_waiting);
  out.set_shared_blases_waiting(use.shared_blases_waiting);
  out.set_blases_built(use.blases_built);
  out.set_blases_refitted(use.blases_refitted);
  out.set_blas_triangles(use.blas_triangles);
  out.set_shared_blas_bytes(use.shared_blas_bytes);
  out.set_own_blas_bytes(use.own_blas_bytes);
  out.set_own_vertex_bytes(use.own_vertex_bytes);
  out.set_tlas_bytes(use.tlas_bytes);
  out.set_scratch_bytes(use.scratch_bytes);
  out.set_culling_bytes(use.culling_bytes);
  if (!culling) return out;
  v1::CullingUse& states = *out.mutable_culling();
  states.set_inactive(culling->inactive);
  states.set_omitted(culling->omitted);
  states.set_requested(culling->requested);
  states.set_active(culling->active);
  states.set_active_hitboxes(culling->active_hitboxes);
  states.set_boxes(culling->boxes);
  states.set_entries(culling->entries);
  states.set_dropped(culling->dropped);
  states.set_changes(culling->changes);
  states.set_cycles(culling->cycles);
  states.set_wanted(culling->wanted);
  states.set_served(culling->served);
  states.set_left_over(culling->left_over);
  states.set_opened(culling->opened);
  states.set_shown(culling->shown);
  states.set_unshown(culling->unshown);
  return out;
}

v1::ErrorEstimate toWire(const render::ErrorBelief& belief) {
  v1::ErrorEstimate out;
  out.set_variance(static_cast<float>(belief.variance));
  out.set_bias(static_cast<float>(belief.bias));
  return out;
}

v1::Decision toWire(const render::Decision& decision, const render::Observation& frame) {
  v1::Decision out;
  out.set_preset(render::kLadder[decision.rung].name);
  out.set_rung(static_cast<uint32_t>(decision.rung));
  out.set_rungs(static_cast<uint32_t>(render::kRungs));
  out.set_predicted_ms(static_cast<float>(decision.predicted_ms));
  out.set_predicted_error(static_cast<float>(decision.predicted_error));
  out.set_within_reach(decision.within_reach);
  out.set_reason(decision.reason);
  out.set_measured_ms(frame.gpu_ms);
  out.set_scaling_ms(frame.scaling_ms);
  if (frame.variance) out.set_measured_variance(*frame.variance);
  out.set_still(frame.still);
  return out;
}

v1::MemoryUse toWire(const render::MemoryUse& memory) {
  v1::MemoryUse out;
  out.set_raster(memory.raster);
  out.set_ray_tracing(memory.ray_tracing);
  out.set_path_tracing(memory.path_tracing);
  return out;
}

void toWire(const std::vector<render::DroppedSamples>& dropped,
            google::protobuf::RepeatedPtrField<v1::DroppedSamples>& out) {
  for (const render::DroppedSamples& kind : dropped) {
    v1::DroppedSamples& message = *out.Add();
    message.set_pass(kind.pass);
    message.set_cause(kind.cause);
    message.set_samples(kind.samples);
  }
}

v1::FrameTelemetry toWire(const render::FrameStats& stats) {
  v1::FrameTelemetry out;
  fillStats(stats, out);
  out.set_nonfinite(stats.nonfinite);
  toWire(stats.dropped, *out.mutable_dropped_samples());
  out.set_accumulated(stats.accumulated);
  out.set_tlas_instances(stats.tlas_instances);
  out.set_triangles_drawn(stats.triangles_drawn);
  out.set_exposure(static_cast<float>(stats.exposure));
  out.set_time(stats.time);
  return out;
}

}  // namespace helio::service
