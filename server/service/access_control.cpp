#include "service/access_control.h"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/message.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>

namespace helio::service {
namespace {

// A revoked token's streams end within 5 s; this is the longest part of it.
constexpr auto kReloadEvery = std::chrono::seconds(1);
constexpr auto kPolite = std::chrono::seconds(2);  // for a client to take in why
constexpr std::string_view kBearer = "Bearer ";

Failure unauthenticated(const std::string& why) {
  return {v1::ERROR_REASON_UNAUTHENTICATED, {ErrorKind::invalid, why, "authorization", {}, {}}};
}

Failure forbidden(std::string why, std::string value, std::string limit) {
  return {v1::ERROR_REASON_FORBIDDEN,
          {ErrorKind::invalid, std::move(why), "authorization", std::move(value), std::move(limit)}};
}

Failure revoked() {
  return unauthenticated("the token of this call is not valid any more: it was revoked, has expired or was changed");
}

/// What a method's proto says it needs; none: nothing, or there is no such method.
std::optional<v1::Need> needOf(const std::string& method) {
  const auto* found = google::protobuf::DescriptorPool::generated_pool()->FindMethodByName("heliograph.v1." + method);
  if (!found || !found->options().HasExtension(v1::needs)) return std::nullopt;
  auto need = found->options().GetExtension(v1::needs);
  if (need.scope() == v1::SCOPE_UNSPECIFIED) return std::nullopt;
  return need;
}

/// What may be done with a token is the same as before.
bool sameRights(const access::Token& a, const access::Token& b) {
  return a.digest == b.digest && a.scope == b.scope && a.worlds == b.worlds && a.expires == b.expires;
}

}  // namespace

Result<std::unique_ptr<AccessControl>> AccessControl::open(const access::KeyFolder& folder) {
  if (auto good = folder.check(); !good) return good.error();
  std::unique_ptr<AccessControl> control(new AccessControl(folder));
  control->reload();
  control->watcher_ = std::thread([raw = control.get()] { raw->watch(); });
  return control;
}

AccessControl::~AccessControl() {
  {
    std::lock_guard lock(stop_mutex_);
    stopping_ = true;
  }
  stop_.notify_all();
  if (watcher_.joinable()) watcher_.join();
}

Outcome<Caller> AccessControl::identify(const grpc::ServerContextBase& context) const {
  const auto& metadata = context.client_metadata();
  const auto found = metadata.find("authorization");
  if (found == metadata.end())
    return unauthenticated("this server asks for a token; run the helio login line that its operator gave you");
  const std::string_view value(found->second.data(), found->second.size());
  std::lock_guard lock(mutex_);
  const auto* token =
      value.substr(0, kBearer.size()) == kBearer ? access::find(tokens_, value.substr(kBearer.size())) : nullptr;
  if (!token)
    return unauthenticated("this token is unknown here or was revoked; ask the server's operator for another");
  if (token->expired(access::unixTime()))
    return unauthenticated("this token has expired; ask the server's operator for another");
  return Caller{*token};
}

Outcome<Caller> AccessControl::admit(const grpc::ServerContextBase& context, const std::string& method) const {
  if (context.deadline() <= std::chrono::system_clock::now()) return tooLate();
  const auto need = needOf(method);
  if (!need)
    return forbidden("method " + method + " does not say which scope it needs, so nobody may call it", method, "none");
  if (!file_) return Caller{};
  auto caller = identify(context);
  if (!caller) return caller;
  const auto& token = *caller->token;
  // The two enumerations have the same order.
  const auto needed = static_cast<access::Scope>(need->scope());
  if (token.scope < needed)
    return forbidden(fmt::format("token {} has scope {}; {} needs {}", token.id, access::nameOf(token.scope), method,
                                 access::nameOf(needed)),
                     access::nameOf(token.scope), access::nameOf(needed));
  if (need->server_wide() && caller->boundToWorlds())
    return forbidden(fmt::format("token {} is for some worlds only; {} is about the whole server", token.id, method),
                     method, "tokens for every world");
  return caller;
}

Outcome<Caller> AccessControl::admit(const grpc::ServerContextBase& context, const std::string& method,
                                     const google::protobuf::Message& request) const {
  auto caller = admit(context, method);
  if (!caller) return caller;
  const auto* field = request.GetDescriptor()->FindFieldByName("world");
  if (!field) return caller;
  if (auto allowed = checkWorld(*caller, request.GetReflection()->GetString(request, field)); !allowed)
    return allowed.error();
  return caller;
}

Outcome<void> AccessControl::checkWorld(const Caller& caller, const std::string& world) {
  if (caller.mayUse(world)) return {};
  std::string worlds;
  for (const auto& name : caller.token->worlds) worlds += (worlds.empty() ? "" : ", ") + name;
  // It says the same whether or not there is such a world.
  return forbidden(fmt::format("token {} is for {} only", caller.token->id, worlds), world.substr(0, 80), worlds);
}

AccessControl::Session AccessControl::enter(const Caller& caller, End end) {
  if (!caller.token) return nullptr;
  uint64_t number = 0;
  {
    std::lock_guard lock(streams_->mutex);
    number = streams_->next++;
    streams_->open.emplace(number, OpenStream{*caller.token, std::move(end)});
  }
  return Session(this, [streams = streams_, number](void*) {
    std::lock_guard lock(streams->mutex);
    streams->open.erase(number);
  });
}

void AccessControl::reload() {
  if (!file_) return;
  auto read = file_->read();
  {
    std::lock_guard lock(mutex_);
    if (read) {
      tokens_ = std::move(*read);
      complaint_.reset();
    } else if (complaint_ != read.error().message) {
      complaint_ = read.error().message;
      spdlog::error("{}; the tokens stay as they were", read.error().message);
    }
  }
  endRevoked();
}

void AccessControl::endRevoked() {
  std::vector<access::Token> valid;
  {
    std::lock_guard lock(mutex_);
    valid = tokens_;
  }
  const int64_t now = access::unixTime();
  std::lock_guard lock(streams_->mutex);
  for (auto& [number, stream] : streams_->open) {
    const bool holds = std::any_of(valid.begin(), valid.end(), [&stream = stream](const access::Token& token) {
      return token.id == stream.token.id && sameRights(token, stream.token);
    });
    if (holds && !stream.token.expired(now)) continue;
    const bool first = !stream.ended;
    if (first) {
      spdlog::info("token {}: is not valid any more; its stream ends", stream.token.id);
      stream.ended = std::chrono::steady_clock::now();
    } else if (std::chrono::steady_clock::now() - *stream.ended < kPolite) {
      continue;
    }
    stream.end(revoked(), !first);
  }
}

void AccessControl::watch() {
  std::unique_lock lock(stop_mutex_);
  while (!stop_.wait_for(lock, kReloadEvery, [&] { return stopping_; })) {
    lock.unlock();
    reload();
    lock.lock();
  }
}

}  // namespace helio::service
