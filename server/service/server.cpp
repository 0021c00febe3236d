#include "service/server.h"

#include <grpcpp/ext/proto_server_reflection_plugin.h>
#include <grpcpp/grpcpp.h>
#include <grpcpp/security/tls_certificate_provider.h>
#include <grpcpp/security/tls_credentials_options.h>
#include <spdlog/spdlog.h>

#include <condition_variable>
#include <cstdio>
#include <map>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "service/access_service.h"
#include "service/accuracy_run.h"
#include "service/call_counter.h"
#include "service/price_file.h"
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

  grpc::ServerWriteReactor<v1::AccuracyEvent>* MeasureAccuracy(grpc::CallbackServerContext* context,
                                                               const v1::MeasureAccuracyRequest* request) override {
    return AccuracyRun::open(environment_, *context, *request);
  }

 private:
  const StreamEnvironment& environment_;
};

/// TLS with the folder's certificate, which is looked at again every second; none: plain text.
std::shared_ptr<grpc::ServerCredentials> credentialsOf(const std::filesystem::path& keys) {
  if (keys.empty()) return grpc::InsecureServerCredentials();
  const access::KeyFolder folder(keys);
  constexpr unsigned kLookAgainSeconds = 1;
  const auto provider = std::make_shared<grpc::experimental::FileWatcherCertificateProvider>(
      folder.key().string(), folder.certificate().string(), kLookAgainSeconds);
  grpc::experimental::TlsServerCredentialsOptions options(provider);
  options.watch_identity_key_cert_pairs();
  options.set_cert_request_type(GRPC_SSL_DONT_REQUEST_CLIENT_CERTIFICATE);
  return grpc::experimental::TlsServerCredentials(options);
}

/// host of "host:port", "[v6]:port".
std::string hostOf(const std::string& address) {
  const size_t colon = address.rfind(':');
  std::string host = colon == std::string::npos ? address : address.substr(0, colon);
  if (host.size() >= 2 && host.front() == '[' && host.back() == ']') host = host.substr(1, host.size() - 2);
  return host;
}

}  // namespace

bool isLoopback(const std::string& address) {
  const std::string host = hostOf(address);
  // 127.0.0.0/8 in dotted form, ::1, or the name that RFC 6761 gives to loopback.
  if (host == "localhost" || host == "::1") return true;
  int part[4];
  char more;
  if (std::sscanf(host.c_str(), "%d.%d.%d.%d%c", &part[0], &part[1], &part[2], &part[3], &more) != 4) return false;
  for (const int p : part)
    if (p < 0 || p > 255) return false;
  return part[0] == 127;
}

struct Server::Parts {
  Parts(ServerConfig c, std::unique_ptr<AccessControl> control, const render::PriceList& price_list,
        render::Renderer& renderer, store::EditLog& log)
      : config(std::move(c)),
        access(std::move(control)),
        metrics(config.version),
        worlds({&renderer, &log, config.limits.world, config.snapshot_bytes, config.on_fatal, &metrics,
                config.limits.max_edits_per_second},
               config.limits),
        encoders(config.encoder_threads),
        prices(price_list),
        streams{&worlds, access.get(), &metrics, &config.limits, &encoders, &next_viewer, &renderer, &prices},
        world_service(worlds, *access, config.limits, config.gltf_root, config.version, config.advertise,
                      renderer.device()),
        viewer_service(streams),
        render_service(streams),
        telemetry_service(worlds, *access),
        access_service(*access) {}

  const ServerConfig config;
  std::string address;
  const std::unique_ptr<AccessControl> access;
  telemetry::Metrics metrics;
  const Clock::time_point started = Clock::now();
  std::atomic<bool> draining = false;
  WorldRegistry worlds;
  stream::EncoderPool encoders;
  std::atomic<uint64_t> next_viewer = 1;
  const render::PriceList prices;
  StreamEnvironment streams;
  WorldService world_service;
  ViewerService viewer_service;
  RenderService render_service;
  TelemetryService telemetry_service;
  AccessService access_service;
  std::unique_ptr<grpc::Server> server;  // it goes before what it serves
  std::mutex housekeeping_mutex;
  std::condition_variable housekeeping_over;
  bool over = false;
  std::thread housekeeping;

  /// Once a second: dead clients are found out, and who does not come back is forgotten.
  void keepHouse() {
    std::unique_lock lock(housekeeping_mutex);
    while (!housekeeping_over.wait_for(lock, std::chrono::seconds(1), [this] { return over; })) {
      lock.unlock();
      for (const auto& world : worlds.list()) world->tend(Clock::now());
      lock.lock();
    }
  }
};

Server::Server(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}

Result<std::unique_ptr<Server>> Server::start(ServerConfig config, render::Renderer& renderer, store::EditLog& log) {
  const std::string address = config.address;
  if (config.keys.empty() && !isLoopback(address))
    return Error{ErrorKind::invalid,
                 "will not listen on " + address +
                     ": without TLS and tokens everybody who reaches the port may build and destroy; make both with "
                     "heliographd init --keys FOLDER and start with --keys FOLDER, or listen on 127.0.0.1",
                 "listen", address, "127.0.0.0/8, ::1, localhost"};
  auto access = config.keys.empty() ? Result<std::unique_ptr<AccessControl>>(std::make_unique<AccessControl>())
                                    : AccessControl::open(access::KeyFolder(config.keys));
  if (!access) return access.error();
  auto prices =
      config.price_list.empty() ? Result<render::PriceList>(render::usualPrices()) : readPriceList(config.price_list);
  if (!prices) return prices.error();
  if (!config.on_fatal)
    config.on_fatal = [](const Error& error) {
      spdlog::critical("{}", error.message);
      std::abort();
    };

  grpc::EnableDefaultHealthCheckService(true);
  static const bool reflection = (grpc::reflection::InitProtoReflectionServerBuilderPlugin(), true);
  (void)reflection;
  auto parts = std::make_unique<Parts>(std::move(config), std::move(*access), *prices, renderer, log);
  const auto find_source = [&parts = *parts](const Manifest& manifest) {
    return sourceOf(manifest, parts.config.gltf_root, parts.config.limits);
  };
  if (auto restored = parts->worlds.restore(find_source); !restored) return restored.error();
  grpc::ServerBuilder builder;
  int port = 0;
  builder.AddListeningPort(address, credentialsOf(parts->config.keys), &port);
  // Two servers on one port would share its clients between them, without a word.
  builder.AddChannelArgument(GRPC_ARG_ALLOW_REUSEPORT, 0);
  builder.SetMaxReceiveMessageSize(static_cast<int>(parts->config.limits.max_request_bytes));
  // A client that vanished without a word is noticed after 10 s + 5 s.
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIME_MS, 10'000);
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIMEOUT_MS, 5'000);
  builder.AddChannelArgument(GRPC_ARG_HTTP2_MIN_RECV_PING_INTERVAL_WITHOUT_DATA_MS, 5'000);
  builder.AddChannelArgument(GRPC_ARG_MAX_CONCURRENT_STREAMS,
                             static_cast<int>(parts->config.limits.max_streams_per_connection));
  std::vector<std::unique_ptr<grpc::experimental::ServerInterceptorFactoryInterface>> interceptors;
  interceptors.push_back(std::make_unique<CallCounter>(parts->metrics));
  builder.experimental().SetInterceptorCreators(std::move(interceptors));
  builder.RegisterService(&parts->world_service);
  builder.RegisterService(&parts->viewer_service);
  builder.RegisterService(&parts->render_service);
  builder.RegisterService(&parts->telemetry_service);
  builder.RegisterService(&parts->access_service);
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
  parts->housekeeping = std::thread([raw = parts.get()] { raw->keepHouse(); });
  return std::unique_ptr<Server>(new Server(std::move(parts)));
}

Server::~Server() { drain(std::chrono::milliseconds(0)); }

const std::string& Server::address() const { return parts_->address; }

Result<void> Server::createCity(const std::string& world, const scene::CityParameters& parameters) {
  auto source = sourceOf({parameters, {}}, parts_->config.gltf_root, parts_->config.limits);
  if (!source) return source.error().error;
  if (const auto there = parts_->worlds.find(world); there && (*there)->source().manifest.sameSource(source->manifest))
    return {};
  auto created = parts_->worlds.create(world, std::move(*source));
  if (!created) return created.error().error;
  parts_->worlds.await(*created);
  return {};
}

std::string Server::notReady() const {
  if (parts_->draining) return "draining";
  return parts_->worlds.started() ? "" : "starting: worlds are being loaded";
}

std::string Server::metrics() {
  auto& metrics = parts_->metrics;
  std::map<HostedWorld::State, uint64_t> states;
  uint64_t viewers = 0, instances = 0;
  for (const auto& world : parts_->worlds.list()) {
    ++states[world->state()];
    viewers += world->viewers();
    if (const auto content = std::as_const(*world).content()) instances += (*content)->instanceCount();
  }
  metrics.setWorlds("loading", static_cast<double>(states[HostedWorld::State::loading]));
  metrics.setWorlds("ready", static_cast<double>(states[HostedWorld::State::ready]));
  metrics.setWorlds("failed", static_cast<double>(states[HostedWorld::State::failed]));
  metrics.viewers.Set(static_cast<double>(viewers));
  metrics.instances.Set(static_cast<double>(instances));
  metrics.resident.Set(static_cast<double>(telemetry::residentBytes()));
  metrics.uptime.Set(std::chrono::duration<double>(Clock::now() - parts_->started).count());
  metrics.ready.Set(notReady().empty() ? 1 : 0);
  return metrics.text();
}

void Server::drain(std::chrono::milliseconds grace) {
  if (!parts_->server) return;
  parts_->draining = true;
  {
    std::lock_guard lock(parts_->housekeeping_mutex);
    parts_->over = true;
  }
  parts_->housekeeping_over.notify_all();
  parts_->housekeeping.join();
  if (auto* health = parts_->server->GetHealthCheckService()) health->SetServingStatus(false);
  parts_->worlds.drain();
  parts_->telemetry_service.drain();
  parts_->server->Shutdown(std::chrono::system_clock::now() + grace);
  parts_->server->Wait();
  parts_->server.reset();
}

}  // namespace helio::service
