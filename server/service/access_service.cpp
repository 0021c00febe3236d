#include "service/access_service.h"

#include <spdlog/spdlog.h>

#include "service/unary.h"

namespace helio::service {
namespace {

Failure withoutKeys() {
  return Error{ErrorKind::unsupported,
               "this server has no keys and asks nobody for a token; start it with --keys FOLDER (heliographd init)",
               {},
               {},
               {}};
}

}  // namespace

v1::Token toWire(const access::Token& token) {
  v1::Token out;
  out.set_id(token.id);
  out.set_name(token.name);
  out.set_scope(static_cast<v1::Scope>(token.scope));  // the two enumerations have the same order
  for (const auto& world : token.worlds) out.add_worlds(world);
  out.set_created(token.created);
  out.set_expires(token.expires);
  return out;
}

grpc::ServerUnaryReactor* AccessService::CreateToken(grpc::CallbackServerContext* context,
                                                     const v1::CreateTokenRequest* request,
                                                     v1::CreateTokenResponse* out) {
  return unary(access_, *context, "AccessService.CreateToken", *request,
               [&](const Caller&) { return create(*request, *out); });
}

Outcome<void> AccessService::create(const v1::CreateTokenRequest& request, v1::CreateTokenResponse& out) {
  if (!access_.tokens()) return withoutKeys();
  if (!v1::Scope_IsValid(request.scope()))
    return outOfRange("scope", std::to_string(request.scope()), "view, edit, admin");
  const auto created = access_.tokens()->create({request.name(),
                                                 static_cast<access::Scope>(request.scope()),
                                                 {request.worlds().begin(), request.worlds().end()},
                                                 request.lifetime()});
  if (!created) return Failure(created.error());
  access_.reload();
  spdlog::info("token {}: made, scope {}", created->token.id, access::nameOf(created->token.scope));
  *out.mutable_token() = toWire(created->token);
  out.set_secret(created->text);
  return {};
}

grpc::ServerUnaryReactor* AccessService::ListTokens(grpc::CallbackServerContext* context,
                                                    const v1::ListTokensRequest* request, v1::ListTokensResponse* out) {
  return unary(access_, *context, "AccessService.ListTokens", *request, [&](const Caller&) { return list(*out); });
}

Outcome<void> AccessService::list(v1::ListTokensResponse& out) {
  if (!access_.tokens()) return withoutKeys();
  const auto tokens = access_.tokens()->read();
  if (!tokens) return Failure(tokens.error());
  for (const auto& token : *tokens) *out.add_tokens() = toWire(token);
  return {};
}

grpc::ServerUnaryReactor* AccessService::RevokeToken(grpc::CallbackServerContext* context,
                                                     const v1::RevokeTokenRequest* request, v1::RevokeTokenResponse*) {
  return unary(access_, *context, "AccessService.RevokeToken", *request,
               [&](const Caller&) { return revoke(*request); });
}

Outcome<void> AccessService::revoke(const v1::RevokeTokenRequest& request) {
  if (!access_.tokens()) return withoutKeys();
  if (auto gone = access_.tokens()->revoke(request.id()); !gone) return Failure(gone.error());
  spdlog::info("token {}: revoked", request.id());
  access_.reload();
  return {};
}

}  // namespace helio::service
