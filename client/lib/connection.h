// A connection to a server: calls with errors for people, and retries where a retry cannot do harm.
#pragma once

#include <grpcpp/grpcpp.h>

#include <heliograph/v1/access.grpc.pb.h>
#include <heliograph/v1/error.pb.h>
#include <heliograph/v1/render.grpc.pb.h>
#include <heliograph/v1/telemetry.grpc.pb.h>
#include <heliograph/v1/viewer.grpc.pb.h>
#include <heliograph/v1/world.grpc.pb.h>

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "lib/credentials.h"

namespace helio::client {

namespace v1 = heliograph::v1;
using Clock = std::chrono::steady_clock;

/// The status and its ErrorDetail as an Error; the message begins with the status' name.
Error errorOf(const grpc::Status& status, const grpc::ClientContext& context);
v1::ErrorDetail detailOf(const grpc::ClientContext& context);

/// Shares its TCP connection with no other.
class Connection {
 public:
  /// With what `helio login` kept for this address: TLS and a token; or else in plain text. Does not connect yet; the
  /// first call does.
  explicit Connection(std::string address);
  Connection(std::string address, const std::optional<Credentials>& credentials);
  /// To `server` by way of `relay` (host:port), which carries bytes and understands none: with what is kept for the
  /// server, whose certificate must have the server's name.
  static std::unique_ptr<Connection> through(const std::string& relay, const std::string& server);

  const std::string& address() const { return address_; }

  // Reads, and edits, which carry a request id, are repeated while the server cannot be reached (for 3 s) or says when
  // to try again, as it does while a world is being loaded (for 120 s).
  Result<v1::ServerInfo> serverInfo();
  Result<v1::World> createWorld(const v1::CreateWorldRequest& request);  ///< not repeated
  Result<v1::World> world(const std::string& name);
  /// Waits until the world is READY; FAILED is an error (unsupported). `progress` is called while it waits.
  Result<v1::World> readyWorld(const std::string& name, const std::function<void()>& progress = {});
  Result<std::vector<v1::World>> worlds();
  Result<void> deleteWorld(const std::string& name);                                           ///< not repeated
  Result<v1::RepairWorldResponse> repairWorld(const std::string& name, uint64_t accept_loss);  ///< not repeated
  /// Fills in a request id where there is none.
  Result<v1::ApplyEditsResponse> apply(v1::ApplyEditsRequest request);
  Result<std::vector<v1::Prefab>> prefabs(const std::string& world);
  /// Instances in a cylinder, at most `limit`.
  Result<std::vector<v1::Instance>> instances(const std::string& world, float x, float z, float radius, size_t limit);

  // Tokens, for who has scope admin. Not repeated.
  Result<v1::CreateTokenResponse> createToken(const v1::CreateTokenRequest& request);
  Result<std::vector<v1::Token>> tokens();
  Result<void> revokeToken(const std::string& id);

  struct Picture {
    v1::RenderHeader header;
    std::string bytes;
  };
  /// One picture; `progress` gets samples so far and wanted.
  Result<Picture> render(const v1::RenderRequest& request, const std::function<void(uint32_t, uint32_t)>& progress);

  struct Accuracy {
    v1::AccuracyResult result;
    std::vector<std::string> pictures;  ///< PNG, in the order of result.pictures
  };
  /// The true error of a live picture; `progress` is called for each event of the reference.
  Result<Accuracy> measureAccuracy(const v1::MeasureAccuracyRequest& request,
                                   const std::function<void(const v1::AccuracyProgress&)>& progress);

  /// Calls `each` with every sample until it returns false.
  Result<void> watch(const v1::WatchTelemetryRequest& request,
                     const std::function<bool(const v1::TelemetrySample&)>& each);

  v1::ViewerService::Stub& viewers() { return *viewers_; }

  /// Names the world in the call's metadata, for proxies.
  static void route(grpc::ClientContext& context, const std::string& world);

  template <typename Request, typename Response>
  using Method = std::function<grpc::Status(grpc::ClientContext*, const Request&, Response*)>;

 private:
  Connection(std::string address, const Result<std::optional<Credentials>>& stored, const std::string& relay);
  void connect(const std::string& to, const std::optional<Credentials>& credentials, grpc::ChannelArguments arguments);
  template <typename Request, typename Response>
  Result<Response> call(const Method<Request, Response>& method, const std::string& world, const Request& request,
                        bool repeat);
  Error unreachable(const Error& error) const;

  std::string address_;
  bool encrypted_ = false;
  std::optional<Error> unusable_;  ///< the credentials could not be read: what every call says
  std::unique_ptr<v1::WorldService::Stub> worlds_;
  std::unique_ptr<v1::ViewerService::Stub> viewers_;
  std::unique_ptr<v1::RenderService::Stub> renders_;
  std::unique_ptr<v1::TelemetryService::Stub> telemetry_;
  std::unique_ptr<v1::AccessService::Stub> access_;
};

}  // namespace helio::client
