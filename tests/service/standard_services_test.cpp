// What every gRPC tool expects of a server: health and reflection. Spoken by hand, in the wire format of their protos,
// since Debian ships neither proto.
#include <grpcpp/generic/generic_stub.h>

#include "fixture.h"

namespace helio::test {
namespace {

grpc::ByteBuffer bytes(const std::string& text) {
  const grpc::Slice slice(text);
  return {&slice, 1};
}

std::string text(const grpc::ByteBuffer& buffer) {
  std::vector<grpc::Slice> slices;
  EXPECT_TRUE(buffer.Dump(&slices).ok());
  std::string result;
  for (const grpc::Slice& slice : slices) result.append(reinterpret_cast<const char*>(slice.begin()), slice.size());
  return result;
}

class StandardServices : public ServiceTest {
 protected:
  /// One message to `method`, and the first that comes back.
  grpc::Status exchange(const std::string& method, const std::string& request, std::string& response) {
    grpc::GenericStub stub(channel_);
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + std::chrono::seconds(20));
    grpc::CompletionQueue queue;
    grpc::ByteBuffer answer;
    grpc::Status status;
    const auto wait = [&queue] {
      void* tag = nullptr;
      bool ok = false;
      return queue.Next(&tag, &ok) && ok;
    };
    const auto stream = stub.PrepareCall(&context, method, &queue);
    stream->StartCall(nullptr);
    if (wait()) {
      stream->Write(bytes(request), nullptr);
      wait();
      stream->Read(&answer, nullptr);
      if (wait()) response = text(answer);
      stream->WritesDone(nullptr);
      wait();
    }
    stream->Finish(&status, nullptr);
    wait();
    queue.Shutdown();
    while (wait()) {}
    return status;
  }
};

/// HealthCheckRequest{service} and HealthCheckResponse{status = SERVING}.
std::string healthOf(const std::string& service) {
  return service.empty() ? "" : "\x0a" + std::string(1, static_cast<char>(service.size())) + service;
}
const std::string kServing = "\x08\x01";

TEST_F(StandardServices, HealthIsServing) {
  std::string response;
  EXPECT_TRUE(exchange("/grpc.health.v1.Health/Check", healthOf(""), response).ok());
  EXPECT_EQ(response, kServing);
  const grpc::Status unknown = exchange("/grpc.health.v1.Health/Check", healthOf("heliograph.v1.Nothing"), response);
  EXPECT_EQ(unknown.error_code(), grpc::StatusCode::NOT_FOUND);
}

TEST_F(StandardServices, ReflectionListsOurServices) {
  std::string response;
  const std::string list_services("\x3a\x01*", 3);  // ServerReflectionRequest{list_services = "*"}
  const std::string method = "/grpc.reflection.v1alpha.ServerReflection/ServerReflectionInfo";
  EXPECT_TRUE(exchange(method, list_services, response).ok());
  for (const char* service : {"WorldService", "ViewerService", "RenderService", "TelemetryService"})
    EXPECT_THAT(response, testing::HasSubstr(std::string("heliograph.v1.") + service));
}

}  // namespace
}  // namespace helio::test
