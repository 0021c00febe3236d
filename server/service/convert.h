// From the wire's messages to the server's types, with every check, and back.
#pragma once

#include <heliograph/v1/render.pb.h>
#include <heliograph/v1/viewer.pb.h>
#include <heliograph/v1/world.pb.h>

#include <string>
#include <vector>

#include "render/controller.h"
#include "render/renderer.h"
#include "service/failure.h"
#include "service/limits.h"
#include "world/world.h"

namespace helio::service {

/// What a viewer asked for, with the defaults filled in.
struct ViewerSettings {
  render::ViewSettings view;
  std::optional<render::Goal> goal{};  ///< decides bounces, samples and denoiser
  uint32_t max_fps = 30;
  uint32_t max_latency_ms = 1000;
  int jpeg_quality = 80;   ///< at most, of a moving picture
  int still_quality = 95;  ///< likewise of a still one
  uint32_t max_kbps = 0;   ///< 0: what the connection carries
  bool paused = false;
  uint32_t revision = 0;
};

Outcome<ViewerSettings> fromWire(const v1::Settings& settings, const Limits& limits);
v1::Settings toWire(const ViewerSettings& settings);

/// `field` is how the sender calls it: "camera", "hello.camera".
Outcome<scene::Camera> fromWire(const v1::Camera& camera, const std::string& field, const Limits& limits);
v1::Camera toWire(const scene::Camera& camera);

struct ShotSettings {
  render::ViewSettings view;
  uint32_t samples = 1;  ///< a pixel, in all
  v1::Codec codec = v1::CODEC_PNG;
  int jpeg_quality = 90;
};

Outcome<ShotSettings> fromWire(const v1::RenderRequest& request, const Limits& limits);

/// Checks the form; world::World::resolve checks the meaning.
Outcome<std::vector<world::Edit>> fromWire(const google::protobuf::RepeatedPtrField<v1::Edit>& edits,
                                           const Limits& limits);

v1::Bounds toWire(const scene::Aabb& box);
v1::Sun toWire(const scene::Sun& sun);
v1::RayCounts toWire(const render::Rays& rays);
v1::AccelerationUse toWire(const render::AccelerationUse& use, const std::optional<accel::LipacFigures>& culling);
v1::ErrorEstimate toWire(const render::ErrorBelief& belief);
/// `frame`: the figures of the frame that `decision` was about.
v1::Decision toWire(const render::Decision& decision, const render::Observation& frame);
v1::MemoryUse toWire(const render::MemoryUse& memory);
void toWire(const std::vector<render::DroppedSamples>& dropped,
            google::protobuf::RepeatedPtrField<v1::DroppedSamples>& out);

/// Fields that Frame telemetry and viewer telemetry share: passes, effects, rays, memory, gpu_ms.
template <typename Message>
void fillStats(const render::FrameStats& stats, Message& out) {
  for (const auto& pass : stats.passes) {
    auto* time = out.add_passes();
    time->set_name(pass.name);
    time->set_ms(static_cast<float>(pass.ms));
  }
  for (const auto& effect : stats.effects) {
    auto* cost = out.add_effects();
    cost->set_name(effect.name);
    cost->set_instances(effect.instances);
    cost->set_memory_bytes(effect.memory_bytes);
    cost->set_pass_ms(static_cast<float>(effect.pass_ms));
  }
  out.set_gpu_ms(static_cast<float>(stats.gpu_ms));
  *out.mutable_rays() = toWire(stats.rays);
  *out.mutable_acceleration() = toWire(stats.acceleration, stats.lipac);
  *out.mutable_memory() = toWire(stats.memory);
}

/// The whole message but id, data and what only the viewer's stream knows.
v1::FrameTelemetry toWire(const render::FrameStats& stats);

}  // namespace helio::service
