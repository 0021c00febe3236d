#include "cli/recording.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace helio::cli {
namespace {

double seconds(client::Clock::duration d) { return std::chrono::duration<double>(d).count(); }

/// Whole microseconds are all that the clocks are worth.
double rounded(double ms) { return std::round(ms * 1000) / 1000; }

Json orNull(const std::optional<double>& value) { return value ? Json(rounded(*value)) : Json(); }

Json summary(std::vector<double> values) {
  if (values.empty()) return {{"median", nullptr}, {"p95", nullptr}, {"max", nullptr}};
  std::sort(values.begin(), values.end());
  const auto quantile = [&](double q) { return rounded(values[std::lround(q * double(values.size() - 1))]); };
  return {{"median", quantile(0.5)}, {"p95", quantile(0.95)}, {"max", rounded(values.back())}};
}

Json stages(const v1::Stages& stages, double present_ms) {
  return {{"camera_wait", stages.camera_wait_us() / 1e3},
          {"tick", stages.tick_us() / 1e3},
          {"mailbox", stages.mailbox_us() / 1e3},
          {"encode", stages.encode_us() / 1e3},
          {"queue", stages.queue_us() / 1e3},
          {"previous_write", stages.previous_write_us() / 1e3},
          {"present", rounded(present_ms)}};
}

/// With what it was decided by: the decisions of a session can be made again from its frames.
Json decision(const v1::Decision& d) {
  return {{"preset", d.preset()},
          {"rung", d.rung()},
          {"predicted_ms", rounded(double(d.predicted_ms()))},
          {"predicted_error", d.predicted_error()},
          {"within_reach", d.within_reach()},
          {"reason", d.reason()},
          {"measured_ms", d.measured_ms()},
          {"scaling_ms", d.scaling_ms()},
          {"measured_variance", d.has_measured_variance() ? Json(d.measured_variance()) : Json()},
          {"still", d.still()}};
}

}  // namespace

void Recording::add(const v1::Frame& frame, const Shown& shown) {
  const auto& telemetry = frame.telemetry();
  const auto& p = shown.view.position;
  const auto& r = shown.view.rotation;
  Json passes = Json::object(), effects = Json::array();
  for (const auto& pass : telemetry.passes()) passes[pass.name()] = rounded(double(pass.ms()));
  for (const auto& effect : telemetry.effects())
    effects.push_back({{"name", effect.name()},
                       {"instances", effect.instances()},
                       {"memory_bytes", effect.memory_bytes()},
                       {"pass_ms", rounded(double(effect.pass_ms()))}});
  const auto& rays = telemetry.rays();
  const auto& memory = telemetry.memory();
  Json json = {
      {"file", shown.file},
      {"id", frame.id()},
      {"t", rounded(seconds(shown.stored - start_))},
      {"tick", frame.tick()},
      {"applied_seq", frame.applied_seq()},
      {"camera",
       {{"id", frame.camera_id()},
        {"position", {p.x, p.y, p.z}},
        {"rotation", {r.x, r.y, r.z, r.w}},
        {"vfov", shown.view.vfov}}},
      {"width", frame.width()},
      {"height", frame.height()},
      {"bytes", frame.data().size()},
      {"passes", std::move(passes)},
      {"gpu_ms", rounded(double(telemetry.gpu_ms()))},
      {"rays",
       {{"primary", rays.primary()},
        {"bounce", rays.bounce()},
        {"shadow", rays.shadow()},
        {"retrace", rays.retrace()}}},
      {"effects", std::move(effects)},
      {"memory",
       {{"raster", memory.raster()}, {"ray_tracing", memory.ray_tracing()}, {"path_tracing", memory.path_tracing()}}},
      {"accumulated", telemetry.accumulated()},
      {"tlas_instances", telemetry.tlas_instances()},
      {"triangles_drawn", telemetry.triangles_drawn()},
      {"nonfinite", telemetry.nonfinite()},
      {"exposure", telemetry.exposure()},
      {"decision", telemetry.has_decision() ? decision(telemetry.decision()) : Json()},
      {"error", telemetry.has_error()
                    ? Json{{"variance", telemetry.error().variance()}, {"bias", telemetry.error().bias()}}
                    : Json()},
      {"world_time", telemetry.time()},
      {"stages", stages(telemetry.stages(), shown.present_ms)},
      {"motion_to_photon_ms", orNull(shown.motion_to_photon_ms)},
      {"edit_to_picture_ms", nullptr},
      {"dropped_before", telemetry.dropped_before()},
      {"events", Json::array()}};
  frames_.push_back({std::move(json), frame.camera_id(), frame.applied_seq(), shown.stored});
  if (shown.motion_to_photon_ms) motion_to_photon_.push_back(*shown.motion_to_photon_ms);
  gpu_.push_back(double(telemetry.gpu_ms()));
  dropped_ += telemetry.dropped_before();
  bytes_ += frame.data().size();
}

double Recording::framesPerSecond() const {
  return frames_.empty() ? 0 : double(frames_.size()) / std::max(1e-3, seconds(frames_.back().stored - start_));
}

Json Recording::document(const std::vector<Mark>& marks) const {
  std::vector<Entry> frames = frames_;
  std::vector<double> edit_to_picture;
  Json edits = Json::array();
  for (const auto& mark : marks) {
    const auto first = std::find_if(frames.begin(), frames.end(), [&](const Entry& frame) {
      return mark.seq != 0 ? frame.applied_seq >= mark.seq : frame.camera_id >= mark.camera_id;
    });
    const bool seen = first != frames.end();
    if (seen) first->json["events"].push_back(mark.label);
    if (mark.seq == 0) continue;
    std::optional<double> latency;
    if (seen) {
      latency = 1000 * seconds(first->stored - mark.sent);
      edit_to_picture.push_back(*latency);
      first->json["edit_to_picture_ms"] = rounded(*latency);
    }
    edits.push_back({{"t", rounded(seconds(mark.sent - start_))},
                     {"label", mark.label},
                     {"seq", mark.seq},
                     {"edit_to_picture_ms", orNull(latency)},
                     {"frame", seen ? first->json["id"] : Json()}});
  }
  Json out = Json::array();
  for (auto& frame : frames) out.push_back(std::move(frame.json));
  return {{"summary",
           {{"frames", frames.size()},
            {"dropped", dropped_},
            {"bytes", bytes_},
            {"seconds", frames.empty() ? 0.0 : rounded(seconds(frames.back().stored - start_))},
            {"frames_per_second", rounded(framesPerSecond())},
            {"motion_to_photon_ms", summary(motion_to_photon_)},
            {"edit_to_picture_ms", summary(std::move(edit_to_picture))},
            {"gpu_ms", summary(gpu_)}}},
          {"edits", std::move(edits)},
          {"frames", std::move(out)}};
}

}  // namespace helio::cli
