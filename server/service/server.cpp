#include "service/server.h"

#include <grpcpp/ext/proto_server_reflection_plugin.h>
#include <grpcpp/grpcpp.h>
#include <spdlog/spdlog.h>

#include <utility>

#include "service/shot.h"
#include "service/telemetry_service.h"
#include "service/viewer_stream.h"
#include "service/world_service.h"
#include "service/world_source.h"

namespace helio::service {
namespace {

class ViewerService final : public v1::ViewerService::CallbackService {
 public:
  explicit ViewerService(const StreamEnvironment& environment) : environment_(environment) {}
  grpc::ServerBidiReactor<v1::ViewerMessage, v1::ServerMessage>* Attach(grpc::CallbackServerContext* context) override {
    return ViewerStream::open(environment_, *context);
  }

 private:
  const StreamEnvironment& environment_;
};

class RenderService final : public v1::RenderService::CallbackService {
 public:
  explicit RenderService(const StreamEnvironment& environment) : environment_(environment) {}
  grpc::ServerWriteReactor<v1::RenderEvent>* Render(grpc::CallbackServerContext* context,
                                                    const v1::RenderRequest* request) override {
    return Shot::open(environment_, *context, *request);
  }

 private:
  const StreamEnvironment& environment_;
};

/// host of "host:port", "[v6]:port".
std::string hostOf(const std::string& address) {
  const size_t colon = address.rfind(':');
  std::string host = colon == std::string::npos ? address : address.substr(0, colon);
  if (host.size() >= 2 && host.front() == '[' && host.back() == ']') host = host.substr(1, host.size() - 2);
  return host;
}

/// 127.0.0.0/8 in dotted form, ::1, or the name that RFC 6761 gives to loopback.
bool isLoopback(const std::string& host) {
  if (host == "localhost" || host == "::1") return true;
  int part[4];
  char more;
  if (std::sscanf(host.c_str(), "%d.%d.%d.%d%c", &part[0], &part[1], &part[2], &part[3], &more) != 4) return false;
  for (const int p : part)
    if (p < 0 || p > 255) return false;
  return part[0] == 127;
}

}  // namespace

struct Server::Parts {
  Parts(ServerConfig c, render::Renderer& renderer, store::EditLog& log)
      : config(std::move(c)),
        worlds({&renderer, &log, config.limits.world, config.snapshot_bytes, config.on_fatal}, config.limits),
        encoders(config.encoder_threads),
        streams{&worlds, &config.limits, &encoders, &next_viewer},
        world_service(worlds, config.limits, config.gltf_root, config.version, renderer.device()),
        viewer_service(streams),
        render_service(streams),
        telemetry_service(worlds) {}

  const ServerConfig config;
  std::string address;
  WorldRegistry worlds;
  stream::EncoderPool encoders;
  std::atomic<uint64_t> next_viewer = 1;
  StreamEnvironment streams;
  WorldService world_service;
  ViewerService viewer_service;
  RenderService render_service;
  TelemetryService telemetry_service;
  std::unique_ptr<grpc::Server> server;  // last: it goes before what it serves
};

Server::Server(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}

Result<std::unique_ptr<Server>> Server::start(ServerConfig config, render::Renderer& renderer, store::EditLog& log) {
  const std::string address = config.address, host = hostOf(address);
  if (!isLoopback(host))
    return Error{
        ErrorKind::invalid,
        "will not listen on " + address +
            ": without TLS and tokens everybody who reaches the port may build and destroy; use 127.0.0.1, ::1 or "
            "localhost, and a tunnel such as ssh -L from elsewhere",
        "listen", address, "127.0.0.0/8, ::1, localhost"};
  if (!config.on_fatal)
    config.on_fatal = [](const Error& error) {
      spdlog::critical("{}", error.message);
      std::abort();
    };

  grpc::EnableDefaultHealthCheckService(true);
  static const bool reflection = (grpc::reflection::InitProtoReflectionServerBuilderPlugin(), true);
  (void)reflection;
  auto parts = std::make_unique<Parts>(std::move(config), renderer, log);
  const auto find_source = [&parts = *parts](const Manifest& manifest) {
    return sourceOf(manifest, parts.config.gltf_root, parts.config.limits);
  };
  if (auto restored = parts->worlds.restore(find_source); !restored) return restored.error();
  grpc::ServerBuilder builder;
  int port = 0;
  builder.AddListeningPort(address, grpc::InsecureServerCredentials(), &port);
  // Two servers on one port would share its clients between them, without a word.
  builder.AddChannelArgument(GRPC_ARG_ALLOW_REUSEPORT, 0);
  builder.SetMaxReceiveMessageSize(static_cast<int>(parts->config.limits.max_request_bytes));
  // A client that vanished without a word is noticed after 10 s + 5 s.
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIME_MS, 10'000);
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIMEOUT_MS, 5'000);
  builder.AddChannelArgument(GRPC_ARG_HTTP2_MIN_RECV_PING_INTERVAL_WITHOUT_DATA_MS, 5'000);
  builder.RegisterService(&parts->world_service);
  builder.RegisterService(&parts->viewer_service);
  builder.RegisterService(&parts->render_service);
  builder.RegisterService(&parts->telemetry_service);
  parts->server = builder.BuildAndStart();
  if (!parts->server || port == 0) {
    parts->server.reset();
    return Error{ErrorKind::unavailable,
                 "cannot listen on " + address + ": is another server there already?",
                 "listen",
                 address,
                 {}};
  }
  parts->address = address.substr(0, address.rfind(':')) + ":" + std::to_string(port);
  return std::unique_ptr<Server>(new Server(std::move(parts)));
}

Server::~Server() { drain(std::chrono::milliseconds(0)); }

const std::string& Server::address() const { return parts_->address; }

Result<void> Server::createCity(const std::string& world, const scene::CityParameters& parameters) {
  auto source = sourceOf({parameters, {}}, parts_->config.gltf_root, parts_->config.limits);
  if (!source) return source.error().error;
  if (const auto there = parts_->worlds.find(world); there && (*there)->source().manifest.sameSource(source->manifest))
    return {};
  if (auto created = parts_->worlds.create(world, std::move(*source)); !created) return created.error().error;
  return {};
}

void Server::drain(std::chrono::milliseconds grace) {
  if (!parts_->server) return;
  if (auto* health = parts_->server->GetHealthCheckService()) health->SetServingStatus(false);
  parts_->worlds.drain();
  parts_->telemetry_service.drain();
  parts_->server->Shutdown(std::chrono::system_clock::now() + grace);
  parts_->server->Wait();
  parts_->server.reset();
}

}  // namespace helio::service
