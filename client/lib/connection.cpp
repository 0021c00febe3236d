#include "lib/connection.h"

#include <algorithm>
#include <random>
#include <thread>
#include <utility>

namespace helio::client {
namespace {

using namespace std::chrono_literals;

// A reference picture of 8192 x 8192 comes in chunks; nothing that the server sends is larger than this.
constexpr int kMaxAnswerBytes = 64 << 20;
constexpr auto kReachPatience = 3s;
constexpr auto kToldPatience = 120s;
constexpr auto kCallDeadline = 60s;  // a batch of 100,000 placements on a slow disk takes seconds

const char* nameOf(grpc::StatusCode code) {
  switch (code) {
    case grpc::StatusCode::CANCELLED:
      return "CANCELLED";
    case grpc::StatusCode::INVALID_ARGUMENT:
      return "INVALID_ARGUMENT";
    case grpc::StatusCode::DEADLINE_EXCEEDED:
      return "DEADLINE_EXCEEDED";
    case grpc::StatusCode::NOT_FOUND:
      return "NOT_FOUND";
    case grpc::StatusCode::ALREADY_EXISTS:
      return "ALREADY_EXISTS";
    case grpc::StatusCode::RESOURCE_EXHAUSTED:
      return "RESOURCE_EXHAUSTED";
    case grpc::StatusCode::FAILED_PRECONDITION:
      return "FAILED_PRECONDITION";
    case grpc::StatusCode::ABORTED:
      return "ABORTED";
    case grpc::StatusCode::UNAUTHENTICATED:
      return "UNAUTHENTICATED";
    case grpc::StatusCode::PERMISSION_DENIED:
      return "PERMISSION_DENIED";
    case grpc::StatusCode::UNIMPLEMENTED:
      return "UNIMPLEMENTED";
    case grpc::StatusCode::INTERNAL:
      return "INTERNAL";
    case grpc::StatusCode::UNAVAILABLE:
      return "UNAVAILABLE";
    case grpc::StatusCode::DATA_LOSS:
      return "DATA_LOSS";
    default:
      return "UNKNOWN";
  }
}

ErrorKind kindOf(grpc::StatusCode code) {
  switch (code) {
    case grpc::StatusCode::INVALID_ARGUMENT:
    case grpc::StatusCode::UNAUTHENTICATED:
    case grpc::StatusCode::PERMISSION_DENIED:
      return ErrorKind::invalid;
    case grpc::StatusCode::NOT_FOUND:
      return ErrorKind::not_found;
    case grpc::StatusCode::RESOURCE_EXHAUSTED:
      return ErrorKind::limit;
    case grpc::StatusCode::ALREADY_EXISTS:
    case grpc::StatusCode::ABORTED:
      return ErrorKind::conflict;
    case grpc::StatusCode::FAILED_PRECONDITION:
    case grpc::StatusCode::UNIMPLEMENTED:
      return ErrorKind::unsupported;
    case grpc::StatusCode::UNAVAILABLE:
      return ErrorKind::unavailable;
    default:
      return ErrorKind::internal;
  }
}

/// Behind proxies a server that went away is seen as 2 or 13 as well as 14.
bool transportFailed(const grpc::Status& status, const v1::ErrorDetail& detail) {
  if (detail.reason() != v1::ERROR_REASON_UNSPECIFIED) return false;  // the server itself has spoken
  return status.error_code() == grpc::StatusCode::UNAVAILABLE || status.error_code() == grpc::StatusCode::UNKNOWN ||
         status.error_code() == grpc::StatusCode::INTERNAL;
}

std::string newRequestId() {
  static thread_local std::mt19937_64 random(std::random_device{}());
  char text[33];
  std::snprintf(text, sizeof text, "%016llx%016llx", static_cast<unsigned long long>(random()),
                static_cast<unsigned long long>(random()));
  return text;
}

/// A stub's method as a function.
template <typename Stub, typename Request, typename Response>
auto bind(Stub& stub, grpc::Status (Stub::*method)(grpc::ClientContext*, const Request&, Response*)) {
  return Connection::Method<Request, Response>(
      [&stub, method](grpc::ClientContext* context, const Request& request, Response* response) {
        return (stub.*method)(context, request, response);
      });
}

}  // namespace

v1::ErrorDetail detailOf(const grpc::ClientContext& context) {
  v1::ErrorDetail detail;
  const auto& metadata = context.GetServerTrailingMetadata();
  if (const auto found = metadata.find("heliograph-error-bin"); found != metadata.end())
    detail.ParseFromArray(found->second.data(), static_cast<int>(found->second.size()));
  return detail;
}

Error errorOf(const grpc::Status& status, const grpc::ClientContext& context) {
  const auto detail = detailOf(context);
  return {kindOf(status.error_code()),
          std::string(nameOf(status.error_code())).append(": ").append(status.error_message()), detail.field(),
          detail.value(), detail.limit()};
}

Connection::Connection(std::string address) : Connection(address, CredentialStore().find(address), {}) {}

Connection::Connection(std::string address, const std::optional<Credentials>& credentials)
    : address_(std::move(address)) {
  connect(address_, credentials, {});
}

Connection::Connection(std::string address, const Result<std::optional<Credentials>>& stored, const std::string& relay)
    : address_(std::move(address)) {
  if (!stored) unusable_ = stored.error();
  grpc::ChannelArguments arguments;
  if (!relay.empty()) {
    const std::string host = address_.substr(0, address_.rfind(':'));
    arguments.SetSslTargetNameOverride(host.front() == '[' ? host.substr(1, host.size() - 2) : host);
  }
  connect(relay.empty() ? address_ : relay, stored ? *stored : std::nullopt, arguments);
}

std::unique_ptr<Connection> Connection::through(const std::string& relay, const std::string& server) {
  return std::unique_ptr<Connection>(new Connection(server, CredentialStore().find(server), relay));
}

void Connection::connect(const std::string& to, const std::optional<Credentials>& credentials,
                         grpc::ChannelArguments arguments) {
  encrypted_ = credentials.has_value();
  arguments.SetMaxReceiveMessageSize(kMaxAnswerBytes);
  arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);  // a TCP connection of its own
  arguments.SetInt(GRPC_ARG_INITIAL_RECONNECT_BACKOFF_MS, 100);
  arguments.SetInt(GRPC_ARG_MIN_RECONNECT_BACKOFF_MS, 5000);  // an attempt's time limit, for far and busy servers
  const auto channel = makeChannel(to, credentials, arguments);
  worlds_ = v1::WorldService::NewStub(channel);
  viewers_ = v1::ViewerService::NewStub(channel);
  renders_ = v1::RenderService::NewStub(channel);
  telemetry_ = v1::TelemetryService::NewStub(channel);
  access_ = v1::AccessService::NewStub(channel);
}

void Connection::route(grpc::ClientContext& context, const std::string& world) {
  if (!world.empty()) context.AddMetadata("heliograph-world", world);
}

Error Connection::unreachable(const Error& error) const {
  const std::string hint =
      encrypted_ ? "start heliographd --keys, or name another with --server; is " + address_ +
                       " among the hosts of its certificate (heliographd init --renew --host)?"
                 : "start heliographd, or name another with --server; if it asks for tokens, helio login first";
  return {ErrorKind::unavailable,
          "no server answers at " + address_ + " (" + error.message + "); " + hint,
          "server",
          address_,
          {}};
}

template <typename Request, typename Response>
Result<Response> Connection::call(const Method<Request, Response>& method, const std::string& world,
                                  const Request& request, bool repeat) {
  if (unusable_) return *unusable_;
  const auto start = Clock::now();
  auto wait = std::chrono::milliseconds(100);
  for (;;) {
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + kCallDeadline);
    route(context, world);
    Response response;
    const auto status = method(&context, request, &response);
    if (status.ok()) return response;
    const auto detail = detailOf(context);
    const bool transport = transportFailed(status, detail);
    const bool told = detail.retry_after_ms() > 0 && (status.error_code() == grpc::StatusCode::UNAVAILABLE ||
                                                      status.error_code() == grpc::StatusCode::RESOURCE_EXHAUSTED);
    const auto patience = told ? Clock::duration(kToldPatience) : Clock::duration(kReachPatience);
    if (!repeat || !(transport || told) || Clock::now() - start > patience) {
      const Error error = errorOf(status, context);
      return transport ? unreachable(error) : error;
    }
    std::this_thread::sleep_for(told ? std::chrono::milliseconds(detail.retry_after_ms()) : wait);
    wait = std::min(2 * wait, std::chrono::milliseconds(1000));
  }
}

Result<v1::ServerInfo> Connection::serverInfo() {
  return call(bind(*worlds_, &v1::WorldService::Stub::GetServerInfo), {}, v1::GetServerInfoRequest(), true);
}

Result<v1::World> Connection::createWorld(const v1::CreateWorldRequest& request) {
  return call(bind(*worlds_, &v1::WorldService::Stub::CreateWorld), request.world(), request, false);
}

Result<v1::World> Connection::world(const std::string& name) {
  v1::GetWorldRequest request;
  request.set_world(name);
  return call(bind(*worlds_, &v1::WorldService::Stub::GetWorld), name, request, true);
}

Result<v1::World> Connection::readyWorld(const std::string& name, const std::function<void()>& progress) {
  for (;;) {
    auto world = this->world(name);
    if (!world || world->state() == v1::WORLD_STATE_READY) return world;
    if (world->state() == v1::WORLD_STATE_FAILED)
      return Error{
          ErrorKind::unsupported, "world \"" + name + "\" could not be loaded: " + world->error(), "world", name, {}};
    if (progress) progress();
    std::this_thread::sleep_for(100ms);
  }
}

Result<std::vector<v1::World>> Connection::worlds() {
  std::vector<v1::World> out;
  v1::ListWorldsRequest request;
  do {
    auto page = call(bind(*worlds_, &v1::WorldService::Stub::ListWorlds), {}, request, true);
    if (!page) return page.error();
    out.insert(out.end(), page->worlds().begin(), page->worlds().end());
    request.set_page_token(page->next_page_token());
  } while (!request.page_token().empty());
  return out;
}

Result<void> Connection::deleteWorld(const std::string& name) {
  v1::DeleteWorldRequest request;
  request.set_world(name);
  auto deleted = call(bind(*worlds_, &v1::WorldService::Stub::DeleteWorld), name, request, false);
  if (!deleted) return deleted.error();
  return {};
}

Result<v1::RepairWorldResponse> Connection::repairWorld(const std::string& name, uint64_t accept_loss) {
  v1::RepairWorldRequest request;
  request.set_world(name);
  request.set_accept_loss(accept_loss);
  return call(bind(*worlds_, &v1::WorldService::Stub::RepairWorld), name, request, false);
}

Result<v1::ApplyEditsResponse> Connection::apply(v1::ApplyEditsRequest request) {
  if (request.request_id().empty()) request.set_request_id(newRequestId());
  return call(bind(*worlds_, &v1::WorldService::Stub::ApplyEdits), request.world(), request, true);
}

Result<std::vector<v1::Prefab>> Connection::prefabs(const std::string& world) {
  v1::ListPrefabsRequest request;
  request.set_world(world);
  auto list = call(bind(*worlds_, &v1::WorldService::Stub::ListPrefabs), world, request, true);
  if (!list) return list.error();
  return std::vector<v1::Prefab>(list->prefabs().begin(), list->prefabs().end());
}

Result<std::vector<v1::Instance>> Connection::instances(const std::string& world, float x, float z, float radius,
                                                        size_t limit) {
  std::vector<v1::Instance> out;
  v1::QueryInstancesRequest request;
  request.set_world(world);
  request.set_x(x);
  request.set_z(z);
  request.set_radius(radius);
  do {
    request.set_page_size(static_cast<uint32_t>(std::min<size_t>(limit - out.size(), 10'000)));
    auto page = call(bind(*worlds_, &v1::WorldService::Stub::QueryInstances), world, request, true);
    if (!page) return page.error();
    out.insert(out.end(), page->instances().begin(), page->instances().end());
    request.set_page_token(page->next_page_token());
  } while (!request.page_token().empty() && out.size() < limit);
  return out;
}

Result<v1::CreateTokenResponse> Connection::createToken(const v1::CreateTokenRequest& request) {
  return call(bind(*access_, &v1::AccessService::Stub::CreateToken), {}, request, false);
}

Result<std::vector<v1::Token>> Connection::tokens() {
  auto list = call(bind(*access_, &v1::AccessService::Stub::ListTokens), {}, v1::ListTokensRequest(), true);
  if (!list) return list.error();
  return std::vector<v1::Token>(list->tokens().begin(), list->tokens().end());
}

Result<void> Connection::revokeToken(const std::string& id) {
  v1::RevokeTokenRequest request;
  request.set_id(id);
  auto revoked = call(bind(*access_, &v1::AccessService::Stub::RevokeToken), {}, request, false);
  if (!revoked) return revoked.error();
  return {};
}

Result<Connection::Picture> Connection::render(const v1::RenderRequest& request,
                                               const std::function<void(uint32_t, uint32_t)>& progress) {
  if (auto ready = readyWorld(request.world()); !ready) return ready.error();
  grpc::ClientContext context;
  route(context, request.world());
  const auto stream = renders_->Render(&context, request);
  Picture picture;
  v1::RenderEvent event;
  while (stream->Read(&event)) {
    switch (event.kind_case()) {
      case v1::RenderEvent::kProgress:
        if (progress) progress(event.progress().samples(), event.progress().wanted());
        break;
      case v1::RenderEvent::kHeader:
        picture.header = event.header();
        break;
      case v1::RenderEvent::kChunk:
        picture.bytes += event.chunk().data();
        break;
      case v1::RenderEvent::KIND_NOT_SET:
        break;
    }
  }
  if (const auto status = stream->Finish(); !status.ok()) return errorOf(status, context);
  if (picture.bytes.size() != picture.header.size())
    return Error{ErrorKind::internal,
                 "the server announced " + std::to_string(picture.header.size()) + " bytes and sent " +
                     std::to_string(picture.bytes.size()),
                 {},
                 {},
                 {}};
  return picture;
}

Result<Connection::Accuracy> Connection::measureAccuracy(
    const v1::MeasureAccuracyRequest& request, const std::function<void(const v1::AccuracyProgress&)>& progress) {
  if (auto ready = readyWorld(request.world()); !ready) return ready.error();
  grpc::ClientContext context;
  route(context, request.world());
  const auto stream = renders_->MeasureAccuracy(&context, request);
  Accuracy accuracy;
  std::string bytes;
  v1::AccuracyEvent event;
  while (stream->Read(&event)) {
    if (event.has_progress() && progress) progress(event.progress());
    if (event.has_result()) accuracy.result = event.result();
    bytes += event.chunk().data();
  }
  if (const auto status = stream->Finish(); !status.ok()) return errorOf(status, context);
  size_t begin = 0;
  for (const auto& picture : accuracy.result.pictures()) {
    accuracy.pictures.push_back(bytes.substr(std::min(begin, bytes.size()), picture.size()));
    begin += picture.size();
  }
  if (begin != bytes.size())
    return Error{
        ErrorKind::internal,
        "the server announced " + std::to_string(begin) + " bytes of pictures and sent " + std::to_string(bytes.size()),
        {},
        {},
        {}};
  return accuracy;
}

Result<void> Connection::watch(const v1::WatchTelemetryRequest& request,
                               const std::function<bool(const v1::TelemetrySample&)>& each) {
  grpc::ClientContext context;
  route(context, request.world());
  const auto stream = telemetry_->Watch(&context, request);
  v1::TelemetrySample sample;
  while (stream->Read(&sample))
    if (!each(sample)) {
      context.TryCancel();
      stream->Finish();
      return {};
    }
  const auto status = stream->Finish();
  if (status.ok()) return {};
  const Error error = errorOf(status, context);
  return transportFailed(status, detailOf(context)) ? unreachable(error) : error;
}

}  // namespace helio::client
