// Worlds: several, their sources, their limits; the address; shots and telemetry.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <set>

#include "fixture.h"

namespace helio::test {
namespace {

using Code = grpc::StatusCode;
using Stub = v1::WorldService::Stub;
namespace fs = std::filesystem;

class WorldTest : public ServiceTest {
 protected:
  Ended create(const std::function<void(v1::CreateWorldRequest&)>& adjust) {
    v1::CreateWorldRequest request;
    request.set_world("w");
    request.mutable_city()->set_instances(1000);
    adjust(request);
    v1::World world;
    return call(&Stub::CreateWorld, request, world);
  }
};

TEST_F(WorldTest, SeveralWorldsLiveBesideEachOther) {
  for (const char* name : {"b", "a", "c"}) makeWorld(name);
  v1::ApplyEditsResponse answer;
  ASSERT_TRUE(apply(buildRequest("b", "x", 1), answer).status.ok());
  EXPECT_EQ(seqOf("a"), 0u);
  EXPECT_EQ(seqOf("b"), 1u);
  Viewer one(*viewers_, "a", 64, 32), two(*viewers_, "b", 64, 32);
  EXPECT_EQ(one.frame().applied_seq(), 0u);
  EXPECT_EQ(two.frame().applied_seq(), 1u);

  std::vector<std::string> names;
  v1::ListWorldsRequest list;
  list.set_page_size(2);
  v1::ListWorldsResponse page;
  do {
    ASSERT_TRUE(call(&Stub::ListWorlds, list, page).status.ok());
    EXPECT_LE(page.worlds_size(), 2);
    for (const auto& world : page.worlds()) names.push_back(world.world());
    list.set_page_token(page.next_page_token());
  } while (!page.next_page_token().empty());
  EXPECT_EQ(names, (std::vector<std::string>{"a", "b", "c"}));
}

TEST_F(WorldTest, AReadyCityTellsItsCamerasAndBounds) {
  ASSERT_TRUE(create([](auto& r) { r.set_world("city"); }).status.ok());
  const auto world = waitUntilReady("city");
  EXPECT_EQ(world.state(), v1::WORLD_STATE_READY);
  EXPECT_GE(world.instances(), 900u);
  EXPECT_LT(world.bounds().min().x(), world.bounds().max().x());
  ASSERT_GE(world.cameras_size(), 1);
  std::set<std::string> names;
  for (const auto& camera : world.cameras()) {
    names.insert(camera.name());
    EXPECT_EQ(camera.camera().pose_size(), 7);
    // What the server tells it takes back.
    Viewer viewer(*viewers_, "city", 64, 32, [&](v1::Hello& hello) { *hello.mutable_camera() = camera.camera(); });
    EXPECT_EQ(viewer.frame().id(), 1u);
  }
  EXPECT_EQ(int(names.size()), world.cameras_size());
}

TEST_F(WorldTest, AWorldThatIsLoadingSaysWhenToTryAgain) {
  v1::CreateWorldRequest request;
  request.set_world("big");
  request.mutable_city()->set_instances(200'000);
  v1::World world;
  ASSERT_TRUE(call(&Stub::CreateWorld, request, world).status.ok());
  EXPECT_EQ(world.state(), v1::WORLD_STATE_LOADING);
  Viewer viewer(*viewers_, "big", 64, 32);
  const auto ended = viewer.end();
  expectFailure(ended, Code::UNAVAILABLE, v1::ERROR_REASON_WORLD_LOADING, "world");
  EXPECT_GT(ended.detail.retry_after_ms(), 0u);
  waitUntilReady("big");
  expectServing("big");
}

TEST_F(WorldTest, WorldsThatCannotBe) {
  makeWorld("taken");
  const auto invalid = v1::ERROR_REASON_INVALID_FIELD;
  expectFailure(create([](auto& r) { r.set_world("taken"); }), Code::ALREADY_EXISTS, v1::ERROR_REASON_WORLD_EXISTS,
                "world");
  for (const char* name : {"Upper", "../up", "-x", "a b"})
    expectFailure(create([&](auto& r) { r.set_world(name); }), Code::INVALID_ARGUMENT, invalid, "world");
  expectFailure(create([](auto& r) { r.set_world(std::string(65, 'x')); }), Code::INVALID_ARGUMENT, invalid, "world");
  expectFailure(create([](auto& r) { r.clear_source(); }), Code::INVALID_ARGUMENT, invalid, "source");
  for (const uint32_t instances : {0u, 999u, 1'000'001u})
    expectFailure(create([&](auto& r) { r.mutable_city()->set_instances(instances); }), Code::INVALID_ARGUMENT, invalid,
                  "city.instances", "[1000, 1000000]");
  v1::ListWorldsResponse list;
  ASSERT_TRUE(call(&Stub::ListWorlds, v1::ListWorldsRequest(), list).status.ok());
  EXPECT_EQ(list.worlds_size(), 1);
  expectServing("taken");
}

TEST_F(WorldTest, WithoutAFolderThereAreNoGltfWorlds) {
  restart([](service::ServerConfig& config) { config.gltf_root.clear(); });
  expectFailure(create([](auto& r) { r.mutable_gltf()->set_path("x.glb"); }), Code::FAILED_PRECONDITION,
                v1::ERROR_REASON_UNSUPPORTED, "gltf.path");
  v1::ServerInfo info;
  ASSERT_TRUE(call(&Stub::GetServerInfo, v1::GetServerInfoRequest(), info).status.ok());
  EXPECT_THAT(info.features(), testing::Not(testing::Contains("gltf")));
}

TEST_F(WorldTest, GltfFilesStayInTheirFolder) {
  const fs::path root = folder_ / "models";
  fs::create_directories(root / "allowed");
  std::ofstream(root / "secret.glb") << "not for you";
  std::ofstream(root / "allowed/broken.glb") << "not a glTF file";
  std::error_code ignored;
  fs::create_symlink(root / "secret.glb", root / "allowed/link.glb", ignored);
  restart([&](service::ServerConfig& config) { config.gltf_root = root / "allowed"; });
  for (const char* path : {"../secret.glb", "/etc/passwd", "link.glb", "", "x/../../secret.glb"})
    expectFailure(create([&](auto& r) { r.mutable_gltf()->set_path(path); }), Code::INVALID_ARGUMENT,
                  v1::ERROR_REASON_INVALID_FIELD, "gltf.path");
  expectFailure(create([](auto& r) { r.mutable_gltf()->set_path("none.glb"); }), Code::NOT_FOUND,
                v1::ERROR_REASON_UNKNOWN_NAME, "gltf.path");

  // A file that is none: the world fails, says why, and can be deleted.
  ASSERT_TRUE(create([](auto& r) { r.mutable_gltf()->set_path("broken.glb"); }).status.ok());
  const auto world = waitUntilReady("w");
  EXPECT_EQ(world.state(), v1::WORLD_STATE_FAILED);
  EXPECT_FALSE(world.error().empty());
  Viewer viewer(*viewers_, "w", 64, 32);
  expectFailure(viewer.end(), Code::FAILED_PRECONDITION, v1::ERROR_REASON_WORLD_FAILED, "world");
  v1::DeleteWorldRequest request;
  request.set_world("w");
  v1::DeleteWorldResponse response;
  EXPECT_TRUE(call(&Stub::DeleteWorld, request, response).status.ok());
  expectFailure(call(&Stub::DeleteWorld, request, response), Code::NOT_FOUND, v1::ERROR_REASON_UNKNOWN_WORLD, "world");
}

TEST_F(WorldTest, ANameIsFreeAgainAfterItsWorldAndItsLogAreGone) {
  makeWorld("city");
  v1::ApplyEditsResponse answer;
  ASSERT_TRUE(apply(buildRequest("city", "a", 1), answer).status.ok());
  v1::DeleteWorldRequest request;
  request.set_world("city");
  v1::DeleteWorldResponse response;
  ASSERT_TRUE(call(&Stub::DeleteWorld, request, response).status.ok());
  const auto again = [](v1::CreateWorldRequest& r) {
    r.set_world("city");
    r.mutable_gltf()->set_path("triangle.gltf");
  };
  eventually([&] { return create(again).status.ok(); }, "the name is free");
  waitUntilReady("city");
  EXPECT_EQ(seqOf("city"), 0u);
  ASSERT_TRUE(apply(buildRequest("city", "a", 1), answer).status.ok());
  EXPECT_FALSE(answer.replayed()) << "the old world's request ids are known";
}

TEST_F(WorldTest, OneWorldTooMany) {
  restart([](service::ServerConfig& config) { config.limits.max_worlds = 1; });
  makeWorld("only");
  expectFailure(create([](auto&) {}), Code::RESOURCE_EXHAUSTED, v1::ERROR_REASON_LIMIT, "world", "1");
  expectServing("only");
}

TEST_F(WorldTest, OnlyLoopbackWithoutCredentials) {
  for (const char* address :
       {"0.0.0.0:0", "192.168.1.5:7700", "[::]:0", "example.org:7700", "127.0.0.1.example.org:1", ":7700"}) {
    service::ServerConfig config;
    config.address = address;
    const auto server = service::Server::start(std::move(config), renderer_, *log_);
    ASSERT_FALSE(server) << address;
    EXPECT_EQ(server.error().kind, ErrorKind::invalid);
    EXPECT_EQ(server.error().field, "listen");
    EXPECT_EQ(server.error().value, address);
    EXPECT_THAT(server.error().message, testing::HasSubstr("heliographd init --keys"));
  }
}

TEST_F(WorldTest, AnAddressInUseIsAnError) {
  service::ServerConfig config;
  config.address = server_->address();
  const auto server = service::Server::start(std::move(config), renderer_, *log_);
  ASSERT_FALSE(server);
  EXPECT_EQ(server.error().kind, ErrorKind::unavailable);
}

TEST_F(WorldTest, TheServerSaysWhatItIs) {
  v1::ServerInfo info;
  ASSERT_TRUE(call(&Stub::GetServerInfo, v1::GetServerInfoRequest(), info).status.ok());
  EXPECT_EQ(info.device(), "painter");
  EXPECT_TRUE(info.cpu_device());
  EXPECT_EQ(info.limits().max_size(), 8192u);
  EXPECT_EQ(info.codecs(0), v1::CODEC_JPEG);
  EXPECT_THAT(info.features(), testing::Contains("edits"));
  EXPECT_THAT(info.features(), testing::Contains("gltf"));
}

// ---- Shots
// -----------------------------------------------------------------------------------------------------------

struct Shot {
  Ended ended;
  v1::RenderHeader header;
  std::string bytes;
  size_t largest_chunk = 0;
  std::vector<uint32_t> progress;
};

Shot shoot(v1::RenderService::Stub& stub, const v1::RenderRequest& request) {
  grpc::ClientContext context;
  const auto stream = stub.Render(&context, request);
  Shot shot;
  v1::RenderEvent event;
  while (stream->Read(&event)) {
    if (event.has_progress()) shot.progress.push_back(event.progress().samples());
    if (event.has_header()) shot.header = event.header();
    shot.bytes += event.chunk().data();
    shot.largest_chunk = std::max(shot.largest_chunk, event.chunk().data().size());
  }
  shot.ended.status = stream->Finish();
  shot.ended.detail = detailOf(context);
  return shot;
}

TEST_F(WorldTest, AShotComesInChunksWithItsSamples) {
  makeWorld("city");
  v1::RenderRequest request;
  request.set_world("city");
  request.set_width(512);
  request.set_height(300);
  request.set_samples(10);
  request.set_codec(v1::CODEC_PFM);
  const auto shot = shoot(*renders_, request);
  ASSERT_TRUE(shot.ended.status.ok()) << shot.ended.status.error_message();
  EXPECT_EQ(shot.bytes.size(), shot.header.size());
  EXPECT_EQ(shot.bytes.substr(0, 10), "PF\n512 300");
  EXPECT_GE(shot.bytes.size(), 512u * 300 * 12);
  EXPECT_LE(shot.largest_chunk, 256u << 10);
  EXPECT_GE(shot.header.samples(), 10u);
  ASSERT_FALSE(shot.progress.empty());
  EXPECT_EQ(shot.progress.back(), 10u);
  EXPECT_TRUE(std::is_sorted(shot.progress.begin(), shot.progress.end()));
  eventually([&] { return renderer_.views() == 0; }, "the shot's view is freed");

  request.set_codec(v1::CODEC_PNG);
  EXPECT_EQ(shoot(*renders_, request).bytes.substr(1, 3), "PNG");
  request.set_codec(v1::CODEC_JPEG);
  EXPECT_EQ(shoot(*renders_, request).bytes.substr(0, 2), "\xff\xd8");
}

TEST_F(WorldTest, ShotsThatAreNone) {
  makeWorld("city");
  const auto fails = [&](const std::function<void(v1::RenderRequest&)>& adjust, Code code, v1::ErrorReason reason,
                         const char* field) {
    v1::RenderRequest request;
    request.set_world("city");
    request.set_width(64);
    request.set_height(64);
    adjust(request);
    expectFailure(shoot(*renders_, request).ended, code, reason, field);
  };
  const auto invalid = v1::ERROR_REASON_INVALID_FIELD;
  fails([](auto& r) { r.set_world("atlantis"); }, Code::NOT_FOUND, v1::ERROR_REASON_UNKNOWN_WORLD, "world");
  fails([](auto& r) { r.set_camera_name("none"); }, Code::NOT_FOUND, v1::ERROR_REASON_UNKNOWN_NAME,
        "request.camera_name");
  fails([](auto& r) { r.set_width(20'000); }, Code::INVALID_ARGUMENT, invalid, "request.width");
  fails([](auto& r) { r.set_samples(1'000'000); }, Code::INVALID_ARGUMENT, invalid, "request.samples");
  fails([](auto& r) { r.set_bounces(99); }, Code::INVALID_ARGUMENT, invalid, "request.bounces");
  fails([](auto& r) { r.set_codec(v1::Codec(42)); }, Code::INVALID_ARGUMENT, invalid, "request.codec");
  fails([](auto& r) { r.mutable_camera(); }, Code::INVALID_ARGUMENT, invalid, "request.camera.pose");
  expectServing("city");
}

TEST_F(WorldTest, AShotThatNobodyWaitsForIsGivenUp) {
  makeWorld("city");
  renderer_.setTickTime(std::chrono::milliseconds(20));
  v1::RenderRequest request;
  request.set_world("city");
  request.set_width(64);
  request.set_height(64);
  request.set_samples(60'000);
  grpc::ClientContext context;
  const auto stream = renders_->Render(&context, request);
  v1::RenderEvent event;
  ASSERT_TRUE(stream->Read(&event));
  context.TryCancel();
  eventually([&] { return renderer_.views() == 0; }, "the shot's view is freed");
  EXPECT_EQ(stream->Finish().error_code(), Code::CANCELLED);
}

// ---- Telemetry
// -------------------------------------------------------------------------------------------------------

TEST_F(WorldTest, TelemetryTellsOfViewersEditsAndEffects) {
  makeWorld("city");
  Viewer viewer(*viewers_, "city", 64, 32);
  viewer.frame();
  v1::ApplyEditsResponse answer;
  ASSERT_TRUE(apply(buildRequest("city", "a", 1), answer).status.ok());
  viewer.frameWhere([](const v1::Frame& f) { return f.applied_seq() >= 1; });

  grpc::ClientContext context;
  v1::WatchTelemetryRequest request;
  request.set_interval_ms(100);
  const auto stream = telemetry_->Watch(&context, request);
  v1::TelemetrySample sample;
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(stream->Read(&sample));
    viewer.frame();
  }
  EXPECT_GT(sample.resident_bytes(), 0u);
  ASSERT_EQ(sample.worlds_size(), 1);
  const auto& world = sample.worlds(0);
  EXPECT_EQ(world.world(), "city");
  EXPECT_EQ(world.seq(), 1u);
  EXPECT_GT(world.ticks(), 0u);
  EXPECT_GT(world.edit_to_picture_ms(), 0.0f);
  ASSERT_EQ(world.viewers_size(), 1);
  EXPECT_EQ(world.viewers(0).width(), 64u);
  EXPECT_GE(world.viewers(0).frames(), 2u);
  EXPECT_EQ(world.viewers(0).applied_seq(), 1u);
  EXPECT_EQ(world.viewers(0).passes(0).name(), "paint");
  EXPECT_EQ(world.viewers(0).effects(0).instances(), 7u);
  ASSERT_EQ(world.viewers(0).dropped_samples_size(), 2);
  EXPECT_EQ(world.viewers(0).dropped_samples(0).cause(), "NaN");
  EXPECT_GE(world.viewers(0).dropped_samples(0).samples(), 2 * world.viewers(0).frames()) << "2 in every frame";
  server_->drain(std::chrono::seconds(5));
  while (stream->Read(&sample)) {}
  const auto status = stream->Finish();
  expectFailure({status, detailOf(context)}, Code::UNAVAILABLE, v1::ERROR_REASON_DRAINING, "");
}

TEST_F(WorldTest, TelemetryOfNothing) {
  const auto fails = [&](const std::function<void(v1::WatchTelemetryRequest&)>& adjust, Code code,
                         v1::ErrorReason reason, const char* field) {
    grpc::ClientContext context;
    v1::WatchTelemetryRequest request;
    adjust(request);
    const auto stream = telemetry_->Watch(&context, request);
    v1::TelemetrySample sample;
    EXPECT_FALSE(stream->Read(&sample));
    const auto status = stream->Finish();
    expectFailure({status, detailOf(context)}, code, reason, field);
  };
  fails([](auto& r) { r.set_world("atlantis"); }, Code::NOT_FOUND, v1::ERROR_REASON_UNKNOWN_WORLD, "world");
  fails([](auto& r) { r.set_interval_ms(5); }, Code::INVALID_ARGUMENT, v1::ERROR_REASON_INVALID_FIELD, "interval_ms");
}

}  // namespace
}  // namespace helio::test
