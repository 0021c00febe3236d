// A server on loopback with the painting renderer, and short names for what every test does.
#pragma once

#include <gmock/gmock.h>
#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include <heliograph/v1/error.pb.h>
#include <heliograph/v1/render.grpc.pb.h>
#include <heliograph/v1/telemetry.grpc.pb.h>
#include <heliograph/v1/viewer.grpc.pb.h>
#include <heliograph/v1/world.grpc.pb.h>

#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "fake_renderer.h"
#include "service/server.h"
#include "store/edit_log.h"

namespace helio::test {

namespace v1 = heliograph::v1;

/// How a call ended.
struct Ended {
  grpc::Status status;
  v1::ErrorDetail detail;
};

/// Status, reason, field and limit of a call that had to fail.
void expectFailure(const Ended& ended, grpc::StatusCode code, v1::ErrorReason reason, const std::string& field,
                   const std::string& limit = {});

/// One viewer. Reads only when it is told to.
class Viewer {
 public:
  Viewer(v1::ViewerService::Stub& stub, const std::string& world, uint32_t width, uint32_t height,
         const std::function<void(v1::Hello&)>& adjust = {});
  explicit Viewer(v1::ViewerService::Stub& stub);  ///< says nothing yet
  ~Viewer();

  bool send(const v1::ViewerMessage& message) { return stream_->Write(message); }
  void look(uint64_t id, float x, uint64_t client_ns = 0);
  void settings(uint32_t revision, uint32_t width, uint32_t height);
  void acknowledge(uint64_t frame_id);
  /// The next message; false: the stream has ended.
  bool read(v1::ServerMessage& message) { return stream_->Read(&message); }
  /// The next frame, acknowledged. The test fails when the stream ends instead.
  v1::Frame frame();
  /// The first frame for which `wanted` holds.
  v1::Frame frameWhere(const std::function<bool(const v1::Frame&)>& wanted);
  v1::Welcome welcome();
  void cancel() { context_.TryCancel(); }
  void halfClose() { stream_->WritesDone(); }
  /// Reads what is left and returns how the stream ended.
  Ended end(std::vector<v1::Notice>* notices = nullptr);

 private:
  grpc::ClientContext context_;
  std::unique_ptr<grpc::ClientReaderWriter<v1::ViewerMessage, v1::ServerMessage>> stream_;
  bool ended_ = false;
};

class ServiceTest : public testing::Test {
 protected:
  ServiceTest();
  ~ServiceTest() override;
  /// With limits other than the usual ones and without worlds; called before anything else.
  void restart(const std::function<void(service::ServerConfig&)>& adjust);
  /// Another server, with what is in `log_`.
  void serve(const std::function<void(service::ServerConfig&)>& adjust);

  /// Two triangles, ready; `buildable_` is their prefab.
  void makeWorld(const std::string& name);
  v1::World waitUntilReady(const std::string& name);

  template <typename Request, typename Response>
  Ended call(grpc::Status (v1::WorldService::Stub::*method)(grpc::ClientContext*, const Request&, Response*),
             const Request& request, Response& response);
  Ended apply(const v1::ApplyEditsRequest& request, v1::ApplyEditsResponse& response);
  /// A batch that builds one instance at x.
  v1::ApplyEditsRequest buildRequest(const std::string& world, const std::string& request_id, float x);
  uint64_t seqOf(const std::string& world);
  /// What every test of a failure ends with: the server serves.
  void expectServing(const std::string& world);
  static void eventually(const std::function<bool()>& holds, const char* what);

  std::filesystem::path folder_;  ///< the server's glTF folder; the world of makeWorld() is in it
  FakeRenderer renderer_;
  std::unique_ptr<store::EditLog> log_;
  std::unique_ptr<service::Server> server_;
  std::shared_ptr<grpc::Channel> channel_;
  std::unique_ptr<v1::WorldService::Stub> worlds_;
  std::unique_ptr<v1::ViewerService::Stub> viewers_;
  std::unique_ptr<v1::RenderService::Stub> renders_;
  std::unique_ptr<v1::TelemetryService::Stub> telemetry_;
  std::string buildable_;  ///< a prefab that may be built
};

v1::ErrorDetail detailOf(const grpc::ClientContext& context);

template <typename Request, typename Response>
Ended ServiceTest::call(grpc::Status (v1::WorldService::Stub::*method)(grpc::ClientContext*, const Request&, Response*),
                        const Request& request, Response& response) {
  grpc::ClientContext context;
  const auto status = (worlds_.get()->*method)(&context, request, &response);
  return {status, detailOf(context)};
}

}  // namespace helio::test
