// The rpcs about worlds. All answer at once; nothing here waits for a scene or a frame.
#pragma once

#include <heliograph/v1/world.grpc.pb.h>

#include <chrono>
#include <filesystem>
#include <string>

#include "service/access_control.h"
#include "service/limits.h"
#include "service/world_registry.h"

namespace helio::service {

class WorldService final : public v1::WorldService::CallbackService {
 public:
  WorldService(WorldRegistry& worlds, const AccessControl& access, const Limits& limits,
               std::filesystem::path gltf_root, std::string version, std::string advertise, render::DeviceInfo device);

  grpc::ServerUnaryReactor* GetServerInfo(grpc::CallbackServerContext*, const v1::GetServerInfoRequest*,
                                          v1::ServerInfo*) override;
  grpc::ServerUnaryReactor* CreateWorld(grpc::CallbackServerContext*, const v1::CreateWorldRequest*,
                                        v1::World*) override;
  grpc::ServerUnaryReactor* GetWorld(grpc::CallbackServerContext*, const v1::GetWorldRequest*, v1::World*) override;
  grpc::ServerUnaryReactor* ListWorlds(grpc::CallbackServerContext*, const v1::ListWorldsRequest*,
                                       v1::ListWorldsResponse*) override;
  grpc::ServerUnaryReactor* DeleteWorld(grpc::CallbackServerContext*, const v1::DeleteWorldRequest*,
                                        v1::DeleteWorldResponse*) override;
  grpc::ServerUnaryReactor* RepairWorld(grpc::CallbackServerContext*, const v1::RepairWorldRequest*,
                                        v1::RepairWorldResponse*) override;
  grpc::ServerUnaryReactor* ApplyEdits(grpc::CallbackServerContext*, const v1::ApplyEditsRequest*,
                                       v1::ApplyEditsResponse*) override;
  grpc::ServerUnaryReactor* QueryInstances(grpc::CallbackServerContext*, const v1::QueryInstancesRequest*,
                                           v1::QueryInstancesResponse*) override;
  grpc::ServerUnaryReactor* Resolve(grpc::CallbackServerContext*, const v1::ResolveRequest*,
                                    v1::ResolveResponse*) override;
  grpc::ServerUnaryReactor* ListPrefabs(grpc::CallbackServerContext*, const v1::ListPrefabsRequest*,
                                        v1::ListPrefabsResponse*) override;

 private:
  Outcome<void> describeServer(const Caller& caller, v1::ServerInfo& out);
  Outcome<void> create(const v1::CreateWorldRequest& request, v1::World& out);
  Outcome<void> list(const Caller& caller, const v1::ListWorldsRequest& request, v1::ListWorldsResponse& out);
  Outcome<void> repair(const v1::RepairWorldRequest& request, v1::RepairWorldResponse& out);
  Outcome<void> edit(const v1::ApplyEditsRequest& request, std::chrono::system_clock::time_point deadline,
                     v1::ApplyEditsResponse& out);
  Outcome<void> query(const v1::QueryInstancesRequest& request, v1::QueryInstancesResponse& out);
  Outcome<void> prefabs(const v1::ListPrefabsRequest& request, v1::ListPrefabsResponse& out);

  WorldRegistry& worlds_;
  const AccessControl& access_;
  const Limits& limits_;
  const std::filesystem::path gltf_root_;
  const std::string version_;
  const std::string advertise_;
  const render::DeviceInfo device_;
};

}  // namespace helio::service
