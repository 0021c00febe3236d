#include "service/world_service.h"

#include <spdlog/fmt/fmt.h>

#include <charconv>
#include <cmath>
#include <utility>

#include "service/access_service.h"
#include "service/convert.h"
#include "service/unary.h"
#include "service/world_source.h"

namespace helio::service {
namespace {

// A take-over takes seconds; who asks more often than this learns nothing new.
constexpr uint32_t kResolveTtlSeconds = 5;

v1::WorldState stateOf(HostedWorld::State state) {
  switch (state) {
    case HostedWorld::State::loading:
      return v1::WORLD_STATE_LOADING;
    case HostedWorld::State::ready:
      return v1::WORLD_STATE_READY;
    case HostedWorld::State::failed:
      return v1::WORLD_STATE_FAILED;
  }
  return v1::WORLD_STATE_UNSPECIFIED;
}

void describe(HostedWorld& world, v1::World& out) {
  out.set_world(world.name());
  out.set_source(world.source().description());
  out.set_state(stateOf(world.state()));
  out.set_error(world.error());
  if (out.state() != v1::WORLD_STATE_READY) return;
  const auto content = world.content();
  if (!content) return;  // deleted meanwhile
  const auto& scene = (*content)->scene();
  out.set_instances((*content)->instanceCount());
  out.set_seq((*content)->seq());
  out.set_epoch(world.epoch());
  out.set_viewers(world.viewers());
  const world::Clock clock = (*content)->clock();
  out.set_time(clock.time);
  out.set_time_rate(clock.rate);
  out.set_time_paused(clock.paused);
  *out.mutable_bounds() = toWire(scene.bounds());
  for (const auto& named : scene.cameras) {
    auto& camera = *out.add_cameras();
    camera.set_name(named.name);
    camera.set_description(named.description);
    *camera.mutable_camera() = toWire(named.camera);
    *camera.mutable_sun() = toWire(named.environment.sun);
  }
}

Outcome<uint32_t> pageSize(uint32_t asked, uint32_t usual, uint32_t most) {
  if (asked > most) return outOfRange("page_size", std::to_string(asked), fmt::format("[0, {}]", most));
  return asked == 0 ? usual : asked;
}

}  // namespace

WorldService::WorldService(WorldRegistry& worlds, const AccessControl& access, const Limits& limits,
                           std::filesystem::path gltf_root, std::string version, std::string advertise,
                           render::DeviceInfo device)
    : worlds_(worlds),
      access_(access),
      limits_(limits),
      gltf_root_(std::move(gltf_root)),
      version_(std::move(version)),
      advertise_(std::move(advertise)),
      device_(std::move(device)) {}

grpc::ServerUnaryReactor* WorldService::GetServerInfo(grpc::CallbackServerContext* context,
                                                      const v1::GetServerInfoRequest* request, v1::ServerInfo* out) {
  return unary(access_, *context, "WorldService.GetServerInfo", *request,
               [&](const Caller& caller) { return describeServer(caller, *out); });
}

Outcome<void> WorldService::describeServer(const Caller& caller, v1::ServerInfo& out) {
  out.set_version(version_);
  out.set_api_minor(2);
  for (const char* feature : {"city", "edits", "time", "shot", "pfm", "telemetry", "tokens", "resume", "resolve",
                              "light_transport", "repair", "accuracy", "goals"})
    out.add_features(feature);
  if (!gltf_root_.empty()) out.add_features("gltf");
  out.set_device(device_.name);
  out.set_driver(device_.driver);
  out.set_cpu_device(device_.cpu);
  out.add_codecs(v1::CODEC_JPEG);
  auto& limits = *out.mutable_limits();
  limits.set_max_worlds(limits_.max_worlds);
  limits.set_max_viewers(limits_.max_viewers);
  limits.set_max_instances(limits_.world.max_instances);
  limits.set_max_edits_per_call(limits_.world.max_edits_per_batch);
  limits.set_max_placements_per_call(limits_.world.max_poses_per_batch);
  limits.set_max_request_bytes(limits_.max_request_bytes);
  limits.set_min_size(limits_.min_size);
  limits.set_max_size(limits_.max_size);
  limits.set_max_fps(limits_.max_fps);
  limits.set_max_shot_samples(limits_.max_shot_samples);
  if (caller.token) *out.mutable_token() = toWire(*caller.token);
  return {};
}

grpc::ServerUnaryReactor* WorldService::CreateWorld(grpc::CallbackServerContext* context,
                                                    const v1::CreateWorldRequest* request, v1::World* out) {
  return unary(access_, *context, "WorldService.CreateWorld", *request,
               [&](const Caller&) { return create(*request, *out); });
}

Outcome<void> WorldService::create(const v1::CreateWorldRequest& request, v1::World& out) {
  auto source = sourceOf(request, gltf_root_, limits_);
  if (!source) return source.error();
  auto world = worlds_.create(request.world(), std::move(*source));
  if (!world) return world.error();
  describe(**world, out);
  return {};
}

grpc::ServerUnaryReactor* WorldService::GetWorld(grpc::CallbackServerContext* context,
                                                 const v1::GetWorldRequest* request, v1::World* out) {
  return unary(access_, *context, "WorldService.GetWorld", *request, [&](const Caller&) -> Outcome<void> {
    auto world = worlds_.find(request->world());
    if (!world) return world.error();
    describe(**world, *out);
    return {};
  });
}

grpc::ServerUnaryReactor* WorldService::ListWorlds(grpc::CallbackServerContext* context,
                                                   const v1::ListWorldsRequest* request, v1::ListWorldsResponse* out) {
  return unary(access_, *context, "WorldService.ListWorlds", *request,
               [&](const Caller& caller) { return list(caller, *request, *out); });
}

Outcome<void> WorldService::list(const Caller& caller, const v1::ListWorldsRequest& request,
                                 v1::ListWorldsResponse& out) {
  const auto size = pageSize(request.page_size(), 100, 1000);
  if (!size) return size.error();
  for (const auto& world : worlds_.list(request.page_token())) {
    if (!caller.mayUse(world->name())) continue;
    if (uint32_t(out.worlds_size()) == *size) {
      out.set_next_page_token(out.worlds(out.worlds_size() - 1).world());
      break;
    }
    describe(*world, *out.add_worlds());
  }
  return {};
}

grpc::ServerUnaryReactor* WorldService::DeleteWorld(grpc::CallbackServerContext* context,
                                                    const v1::DeleteWorldRequest* request, v1::DeleteWorldResponse*) {
  return unary(access_, *context, "WorldService.DeleteWorld", *request,
               [&](const Caller&) { return worlds_.remove(request->world()); });
}

grpc::ServerUnaryReactor* WorldService::RepairWorld(grpc::CallbackServerContext* context,
                                                    const v1::RepairWorldRequest* request,
                                                    v1::RepairWorldResponse* out) {
  return unary(access_, *context, "WorldService.RepairWorld", *request,
               [&](const Caller&) { return repair(*request, *out); });
}

Outcome<void> WorldService::repair(const v1::RepairWorldRequest& request, v1::RepairWorldResponse& out) {
  const auto repaired = worlds_.repair(request.world(), request.accept_loss());
  if (!repaired) return repaired.error();
  describe(*repaired->world, *out.mutable_world());
  out.set_seq(repaired->kept.last_seq);
  out.set_lost_edits(repaired->kept.lost);
  out.set_forgotten_requests(repaired->kept.forgotten_requests);
  return {};
}

grpc::ServerUnaryReactor* WorldService::ApplyEdits(grpc::CallbackServerContext* context,
                                                   const v1::ApplyEditsRequest* request, v1::ApplyEditsResponse* out) {
  return unary(access_, *context, "WorldService.ApplyEdits", *request,
               [&](const Caller&) { return edit(*request, context->deadline(), *out); });
}

Outcome<void> WorldService::edit(const v1::ApplyEditsRequest& request, std::chrono::system_clock::time_point deadline,
                                 v1::ApplyEditsResponse& out) {
  const auto arrived = Clock::now();
  auto world = worlds_.find(request.world());
  if (!world) return world.error();
  const std::string& id = request.request_id();
  if (id.empty() || id.size() > limits_.max_name_length)
    return outOfRange("request_id", id.empty() ? "empty" : std::to_string(id.size()) + " bytes",
                      "1 to " + std::to_string(limits_.max_name_length) + " bytes");
  auto edits = fromWire(request.edits(), limits_);
  if (!edits) return edits.error();
  EditRequest edit{id, {}, std::move(*edits), deadline};
  if (request.has_expected_seq()) edit.expected_seq = request.expected_seq();
  const auto applied = (*world)->apply(edit, arrived);
  if (!applied) return applied.error();
  out.set_seq(applied->seq);
  out.set_epoch(applied->epoch);
  for (const auto& built : applied->built) {
    auto& range = *out.add_built();
    range.set_first(built.first);
    range.set_count(built.count);
  }
  out.set_destroyed(applied->destroyed);
  out.set_replayed(applied->replayed);
  return {};
}

grpc::ServerUnaryReactor* WorldService::QueryInstances(grpc::CallbackServerContext* context,
                                                       const v1::QueryInstancesRequest* request,
                                                       v1::QueryInstancesResponse* out) {
  return unary(access_, *context, "WorldService.QueryInstances", *request,
               [&](const Caller&) { return query(*request, *out); });
}

Outcome<void> WorldService::query(const v1::QueryInstancesRequest& request, v1::QueryInstancesResponse& out) {
  auto world = worlds_.find(request.world());
  if (!world) return world.error();
  auto content = (*world)->content();
  if (!content) return content.error();
  const auto size = pageSize(request.page_size(), 1'000, 10'000);
  if (!size) return size.error();
  if (!std::isfinite(request.x()) || !std::isfinite(request.z()))
    return outOfRange(std::isfinite(request.x()) ? "z" : "x", "not finite", "finite numbers");
  if (!(request.radius() > 0 && request.radius() <= 1e6f))
    return outOfRange("radius", std::to_string(request.radius()), "(0, 1e6]");
  uint64_t after = 0;
  const std::string& token = request.page_token();
  const auto parsed = std::from_chars(token.data(), token.data() + token.size(), after);
  if (!token.empty() && (parsed.ec != std::errc{} || parsed.ptr != token.data() + token.size()))
    return outOfRange("page_token", fmt::format("\"{}\"", token.substr(0, 80)), "tokens of an earlier answer");
  const uint64_t seq = (*content)->seq();
  if (request.min_seq() > seq)
    return Failure{v1::ERROR_REASON_UNAVAILABLE,
                   {ErrorKind::unavailable, "edits are known up to " + std::to_string(seq) + " only; try again",
                    "min_seq", std::to_string(request.min_seq()), std::to_string(seq)},
                   100};

  const auto& scene = (*content)->scene();
  const auto found = (*content)->query({request.x(), request.z()}, request.radius(), after, size_t{*size} + 1);
  for (size_t i = 0; i < std::min<size_t>(found.size(), *size); ++i) {
    auto& instance = *out.add_instances();
    instance.set_id(found[i].id);
    instance.set_prefab(scene.prefabs[found[i].prefab].name);
    for (int column = 0; column < 4; ++column)
      for (int row = 0; row < 3; ++row) instance.add_transform(found[i].transform[column][row]);
  }
  if (found.size() > *size) out.set_next_page_token(std::to_string(found[*size - 1].id));
  out.set_seq(seq);
  return {};
}

grpc::ServerUnaryReactor* WorldService::Resolve(grpc::CallbackServerContext* context, const v1::ResolveRequest* request,
                                                v1::ResolveResponse* out) {
  return unary(access_, *context, "WorldService.Resolve", *request, [&](const Caller&) -> Outcome<void> {
    auto world = worlds_.find(request->world());
    if (!world) return world.error();
    if (auto here = (*world)->content(); !here && here.error().reason == v1::ERROR_REASON_FENCED) return here.error();
    out->set_endpoint(advertise_);
    out->set_epoch((*world)->epoch());
    out->set_ttl(kResolveTtlSeconds);
    return {};
  });
}

grpc::ServerUnaryReactor* WorldService::ListPrefabs(grpc::CallbackServerContext* context,
                                                    const v1::ListPrefabsRequest* request,
                                                    v1::ListPrefabsResponse* out) {
  return unary(access_, *context, "WorldService.ListPrefabs", *request,
               [&](const Caller&) { return prefabs(*request, *out); });
}

Outcome<void> WorldService::prefabs(const v1::ListPrefabsRequest& request, v1::ListPrefabsResponse& out) {
  auto world = worlds_.find(request.world());
  if (!world) return world.error();
  auto content = (*world)->content();
  if (!content) return content.error();
  const auto& scene = (*content)->scene();
  const auto counts = (*content)->prefabCounts();
  for (size_t i = 0; i < scene.prefabs.size(); ++i) {
    const auto& prefab = scene.prefabs[i];
    const auto& mesh = scene.meshes[prefab.mesh];
    auto& entry = *out.add_prefabs();
    entry.set_name(prefab.name);
    entry.set_category(prefab.category);
    entry.set_buildable(prefab.buildable);
    *entry.mutable_bounds() = toWire(mesh.bounds);
    entry.set_triangles(static_cast<uint32_t>(mesh.indices.size() / 3));
    entry.set_instances(counts[i]);
  }
  return {};
}

}  // namespace helio::service
