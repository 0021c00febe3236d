// The rpcs about tokens.
#pragma once

#include <heliograph/v1/access.grpc.pb.h>

#include "service/access_control.h"

namespace helio::service {

class AccessService final : public v1::AccessService::CallbackService {
 public:
  explicit AccessService(AccessControl& access) : access_(access) {}

  grpc::ServerUnaryReactor* CreateToken(grpc::CallbackServerContext*, const v1::CreateTokenRequest*,
                                        v1::CreateTokenResponse*) override;
  grpc::ServerUnaryReactor* ListTokens(grpc::CallbackServerContext*, const v1::ListTokensRequest*,
                                       v1::ListTokensResponse*) override;
  grpc::ServerUnaryReactor* RevokeToken(grpc::CallbackServerContext*, const v1::RevokeTokenRequest*,
                                        v1::RevokeTokenResponse*) override;

 private:
  Outcome<void> create(const v1::CreateTokenRequest& request, v1::CreateTokenResponse& out);
  Outcome<void> list(v1::ListTokensResponse& out);
  Outcome<void> revoke(const v1::RevokeTokenRequest& request);

  AccessControl& access_;
};

v1::Token toWire(const access::Token& token);

}  // namespace helio::service
