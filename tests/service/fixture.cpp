#include "fixture.h"

#include <cstdlib>
#include <fstream>
#include <thread>

namespace helio::test {

using namespace std::chrono_literals;
using Stub = v1::WorldService::Stub;

v1::ErrorDetail detailOf(const grpc::ClientContext& context) {
  v1::ErrorDetail detail;
  const auto& metadata = context.GetServerTrailingMetadata();
  if (const auto found = metadata.find("heliograph-error-bin"); found != metadata.end())
    detail.ParseFromArray(found->second.data(), int(found->second.size()));
  return detail;
}

void expectFailure(const Ended& ended, grpc::StatusCode code, v1::ErrorReason reason, const std::string& field,
                   const std::string& limit) {
  EXPECT_EQ(ended.status.error_code(), code) << ended.status.error_message();
  EXPECT_FALSE(ended.status.error_message().empty());
  EXPECT_EQ(v1::ErrorReason_Name(ended.detail.reason()), v1::ErrorReason_Name(reason)) << ended.status.error_message();
  EXPECT_EQ(ended.detail.field(), field) << ended.status.error_message();
  if (!limit.empty()) { EXPECT_EQ(ended.detail.limit(), limit) << ended.status.error_message(); }
}

// ---- Viewer
// ----------------------------------------------------------------------------------------------------------

Viewer::Viewer(v1::ViewerService::Stub& stub) : stream_(stub.Attach(&context_)) {}

Viewer::Viewer(v1::ViewerService::Stub& stub, const std::string& world, uint32_t width, uint32_t height,
               const std::function<void(v1::Hello&)>& adjust)
    : Viewer(stub) {
  v1::ViewerMessage message;
  auto& hello = *message.mutable_hello();
  hello.set_world(world);
  hello.mutable_settings()->set_width(width);
  hello.mutable_settings()->set_height(height);
  hello.mutable_settings()->mutable_stream()->set_max_fps(60);
  if (adjust) adjust(hello);
  send(message);
}

Viewer::~Viewer() {
  if (ended_) return;
  context_.TryCancel();
  end();
}

void Viewer::look(uint64_t id, float x, uint64_t client_ns) {
  v1::ViewerMessage message;
  auto& camera = *message.mutable_camera();
  camera.set_id(id);
  camera.set_client_ns(client_ns);
  for (const float number : {x, 2.0f, 3.0f, 0.0f, 0.0f, 0.0f, 1.0f}) camera.add_pose(number);
  camera.set_vfov(1.0f);
  send(message);
}

void Viewer::settings(uint32_t revision, uint32_t width, uint32_t height) {
  v1::ViewerMessage message;
  message.mutable_settings()->set_revision(revision);
  message.mutable_settings()->set_width(width);
  message.mutable_settings()->set_height(height);
  send(message);
}

void Viewer::acknowledge(uint64_t frame_id) {
  v1::ViewerMessage message;
  message.mutable_ack()->set_frame_id(frame_id);
  send(message);
}

v1::Frame Viewer::frame() {
  v1::ServerMessage message;
  while (read(message))
    if (message.has_frame()) {
      acknowledge(message.frame().id());
      return message.frame();
    }
  ADD_FAILURE() << "the stream ended" << (ended_ ? "" : ": " + end().status.error_message());
  return {};
}

v1::Frame Viewer::frameWhere(const std::function<bool(const v1::Frame&)>& wanted) {
  for (;;) {
    auto frame = this->frame();
    if (frame.id() == 0 || wanted(frame)) return frame;
  }
}

v1::Welcome Viewer::welcome() {
  v1::ServerMessage message;
  if (!read(message) || !message.has_welcome())
    ADD_FAILURE() << "no welcome" << (ended_ ? "" : ": " + end().status.error_message());
  return message.welcome();
}

Ended Viewer::end(std::vector<v1::Notice>* notices) {
  v1::ServerMessage message;
  while (read(message))
    if (notices && message.has_notice()) notices->push_back(message.notice());
  ended_ = true;
  const auto status = stream_->Finish();
  return {status, detailOf(context_)};
}

// ---- The server
// ------------------------------------------------------------------------------------------------------

namespace {

// One triangle, two nodes: a world that is there at once. The buffer holds three positions, 36 bytes.
constexpr const char* kTriangle = R"({
  "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1]}],
  "nodes": [{"mesh": 0}, {"mesh": 0, "translation": [3, 0, 0]}],
  "meshes": [{"name": "triangle", "primitives": [{"attributes": {"POSITION": 0}}]}],
  "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}],
  "bufferViews": [{"buffer": 0, "byteLength": 36}],
  "buffers": [{"byteLength": 36, "uri": "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]
})";

}  // namespace

ServiceTest::ServiceTest() {
  std::string folder = testing::TempDir() + "heliograph_service_XXXXXX";
  folder_ = mkdtemp(folder.data());
  std::ofstream(folder_ / "triangle.gltf") << kTriangle;
  restart([](service::ServerConfig&) {});
}

ServiceTest::~ServiceTest() {
  server_.reset();
  EXPECT_EQ(renderer_.views(), 0u);
  EXPECT_EQ(renderer_.worlds(), 0u);
  EXPECT_EQ(renderer_.livePixels(), 0);
  EXPECT_EQ(renderer_.misuses(), 0u);
  std::filesystem::remove_all(folder_);
}

void ServiceTest::restart(const std::function<void(service::ServerConfig&)>& adjust) {
  server_.reset();
  log_ = store::makeMemoryEditLog();
  serve(adjust);
}

void ServiceTest::serve(const std::function<void(service::ServerConfig&)>& adjust) {
  server_.reset();
  service::ServerConfig config;
  config.address = "127.0.0.1:0";
  config.version = "test";
  config.gltf_root = folder_;
  config.limits.resume_seconds = 0;  // most tests look at what is freed when a viewer goes
  config.on_fatal = [](const Error& error) { ADD_FAILURE() << "fatal: " << error.message; };
  adjust(config);
  auto server = service::Server::start(std::move(config), renderer_, *log_);
  ASSERT_TRUE(server) << server.error().message;
  server_ = std::move(*server);
  grpc::ChannelArguments arguments;
  arguments.SetMaxReceiveMessageSize(64 << 20);
  channel_ = grpc::CreateCustomChannel(server_->address(), grpc::InsecureChannelCredentials(), arguments);
  worlds_ = v1::WorldService::NewStub(channel_);
  viewers_ = v1::ViewerService::NewStub(channel_);
  renders_ = v1::RenderService::NewStub(channel_);
  telemetry_ = v1::TelemetryService::NewStub(channel_);
}

void ServiceTest::makeWorld(const std::string& name) {
  v1::CreateWorldRequest request;
  request.set_world(name);
  request.mutable_gltf()->set_path("triangle.gltf");
  v1::World world;
  auto created = call(&Stub::CreateWorld, request, world);
  // One of that name may still be on its way out: the server says so, and to try again.
  for (int tries = 0; created.status.error_code() == grpc::StatusCode::UNAVAILABLE && tries < 500; ++tries) {
    std::this_thread::sleep_for(10ms);
    created = call(&Stub::CreateWorld, request, world);
  }
  ASSERT_TRUE(created.status.ok()) << created.status.error_message();
  const auto ready = waitUntilReady(name);
  ASSERT_EQ(ready.state(), v1::WORLD_STATE_READY) << ready.error();
  v1::ListPrefabsRequest list;
  list.set_world(name);
  v1::ListPrefabsResponse prefabs;
  ASSERT_TRUE(call(&Stub::ListPrefabs, list, prefabs).status.ok());
  for (const auto& prefab : prefabs.prefabs())
    if (prefab.buildable()) buildable_ = prefab.name();
  ASSERT_FALSE(buildable_.empty());
}

v1::World ServiceTest::waitUntilReady(const std::string& name) {
  v1::GetWorldRequest request;
  request.set_world(name);
  v1::World world;
  eventually(
      [&] { return call(&Stub::GetWorld, request, world).status.ok() && world.state() != v1::WORLD_STATE_LOADING; },
      "the world is loaded");
  return world;
}

Ended ServiceTest::apply(const v1::ApplyEditsRequest& request, v1::ApplyEditsResponse& response) {
  return call(&Stub::ApplyEdits, request, response);
}

v1::ApplyEditsRequest ServiceTest::buildRequest(const std::string& world, const std::string& request_id, float x) {
  v1::ApplyEditsRequest request;
  request.set_world(world);
  request.set_request_id(request_id);
  auto& build = *request.add_edits()->mutable_build();
  build.set_prefab(buildable_);
  for (const float number : {x, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 1.0f, 1.0f}) build.add_placements(number);
  return request;
}

uint64_t ServiceTest::seqOf(const std::string& world) {
  v1::GetWorldRequest request;
  request.set_world(world);
  v1::World answer;
  EXPECT_TRUE(call(&Stub::GetWorld, request, answer).status.ok());
  return answer.seq();
}

void ServiceTest::expectServing(const std::string& world) {
  Viewer viewer(*viewers_, world, 32, 16);
  viewer.welcome();
  const auto frame = viewer.frame();
  EXPECT_EQ(frame.width(), 32u);
  EXPECT_EQ(frame.height(), 16u);
}

/// Polls; 30 s are only how long a broken test takes to fail.
void ServiceTest::eventually(const std::function<bool()>& holds, const char* what) {
  for (int i = 0; i < 18'000; ++i) {  // three minutes: a sanitizer on a busy machine
    if (holds()) return;
    std::this_thread::sleep_for(10ms);
  }
  ADD_FAILURE() << "never: " << what;
}

}  // namespace helio::test
