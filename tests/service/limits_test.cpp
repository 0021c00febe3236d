// Every limit that is not tested beside what it limits.
#include <fstream>
#include <functional>
#include <map>
#include <thread>

#include "fixture.h"
#include "service/edit_rate.h"

namespace helio::test {
namespace {

using namespace std::chrono_literals;
using Code = grpc::StatusCode;

class LimitsTest : public ServiceTest {
 protected:
  void limited(const std::function<void(service::Limits&)>& adjust) {
    restart([&](service::ServerConfig& config) { adjust(config.limits); });
  }
};

TEST(EditRate, TakesASecondsWorthAndThenItsRate) {
  const service::EditRate::Clock::time_point start{1s};
  service::EditRate rate(100);
  EXPECT_EQ(rate.take(99, start), 0ms);
  EXPECT_EQ(rate.take(101, start), 0ms) << "what one call may hold is taken while there is anything";
  EXPECT_EQ(rate.take(1, start), 1000ms);
  EXPECT_EQ(rate.take(1, start + 500ms), 500ms);
  EXPECT_EQ(rate.take(1, start + 1100ms), 0ms);
  // A long pause fills it to one second's worth, not to more.
  EXPECT_EQ(rate.take(100, start + 1h), 0ms);
  EXPECT_GT(rate.take(1, start + 1h), 0ms);
}

TEST_F(LimitsTest, EditsASecond) {
  limited([](service::Limits& limits) { limits.max_edits_per_second = 4; });
  makeWorld("city");
  makeWorld("other");
  v1::ApplyEditsResponse answer;
  ASSERT_TRUE(apply(buildRequest("city", "1", 1), answer).status.ok());  // an edit with a placement: two
  ASSERT_TRUE(apply(buildRequest("city", "2", 2), answer).status.ok());
  Ended refused;
  for (int i = 0; i < 20 && refused.status.ok(); ++i)
    refused = apply(buildRequest("city", "more " + std::to_string(i), 3), answer);
  expectFailure(refused, Code::RESOURCE_EXHAUSTED, v1::ERROR_REASON_LIMIT, "edits", "4");
  EXPECT_GT(refused.detail.retry_after_ms(), 0u);
  EXPECT_TRUE(apply(buildRequest("other", "1", 1), answer).status.ok()) << "one world's builders stop another's";
  const uint64_t seq = seqOf("city");
  std::this_thread::sleep_for(std::chrono::milliseconds(refused.detail.retry_after_ms()) + 50ms);
  ASSERT_TRUE(apply(buildRequest("city", "later", 4), answer).status.ok());
  EXPECT_EQ(answer.seq(), seq + 1) << "a refused call has left something";
  EXPECT_THAT(server_->metrics(), testing::HasSubstr("heliograph_edits_refused_total 1"));
}

TEST_F(LimitsTest, StreamsAConnection) {
  limited([](service::Limits& limits) { limits.max_streams_per_connection = 1; });
  makeWorld("city");
  v1::ServerInfo info;
  const auto ask = [&](std::chrono::milliseconds patience) {
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + patience);
    return worlds_->GetServerInfo(&context, {}, &info).error_code();
  };
  {
    Viewer viewer(*viewers_, "city", 64, 32);
    viewer.frame();
    EXPECT_EQ(ask(500ms), Code::DEADLINE_EXCEEDED) << "a second stream was let in";
    viewer.frame();
  }
  EXPECT_EQ(ask(20s), Code::OK);
}

TEST_F(LimitsTest, BytesOfAScene) {
  limited([](service::Limits& limits) { limits.max_scene_bytes = 100; });
  v1::CreateWorldRequest request;
  request.set_world("city");
  request.mutable_gltf()->set_path("triangle.gltf");
  v1::World world;
  ASSERT_TRUE(call(&v1::WorldService::Stub::CreateWorld, request, world).status.ok());
  const auto failed = waitUntilReady("city");
  EXPECT_EQ(failed.state(), v1::WORLD_STATE_FAILED);
  EXPECT_THAT(failed.error(), testing::HasSubstr("max-scene-bytes"));
}

TEST_F(LimitsTest, BytesBesideAScene) {
  limited([](service::Limits& limits) { limits.max_scene_bytes = 10'000; });
  std::ofstream(folder_ / "big one.bin") << std::string(20'000, 'x');
  std::ofstream(folder_ / "named.gltf")
      << R"({"asset": {"version": "2.0"}, "buffers": [{"byteLength": 36, "uri": "big%20one.bin"}]})";
  v1::CreateWorldRequest request;
  request.set_world("city");
  request.mutable_gltf()->set_path("named.gltf");
  v1::World world;
  ASSERT_TRUE(call(&v1::WorldService::Stub::CreateWorld, request, world).status.ok());
  EXPECT_THAT(waitUntilReady("city").error(), testing::HasSubstr("max-scene-bytes"));
}

TEST_F(LimitsTest, BytesOfARequest) {
  limited([](service::Limits& limits) { limits.max_request_bytes = 100'000; });
  makeWorld("city");
  auto request = buildRequest("city", "large", 1);
  for (int i = 0; i < 200'000; ++i) request.mutable_edits(0)->mutable_destroy()->add_ids(1'000'000'000 + i);
  v1::ApplyEditsResponse answer;
  EXPECT_EQ(apply(request, answer).status.error_code(), Code::RESOURCE_EXHAUSTED);
  expectServing("city");
}

/// What GetServerInfo tells, each beyond by one. A new field without a case fails.
TEST_F(LimitsTest, EveryLimitThatClientsAreToldOfIsHeld) {
  limited([](service::Limits& limits) {
    limits.max_worlds = 2;
    limits.max_viewers = 2;
    limits.world.max_instances = 10;
    limits.world.max_edits_per_batch = 5;
    limits.world.max_poses_per_batch = 8;
    limits.max_request_bytes = 100'000;
    limits.max_size = 128;
    limits.max_shot_samples = 7;
  });
  makeWorld("city");
  v1::ServerInfo info;
  ASSERT_TRUE(call(&v1::WorldService::Stub::GetServerInfo, {}, info).status.ok());

  const auto edit = [&](const std::function<void(v1::ApplyEditsRequest&)>& adjust) {
    auto request = buildRequest("city", "beyond", 1);
    adjust(request);
    v1::ApplyEditsResponse answer;
    return apply(request, answer);
  };
  const auto placements = [](v1::ApplyEditsRequest& request, int count) {
    auto& numbers = *request.mutable_edits(0)->mutable_build()->mutable_placements();
    const std::vector<float> one(numbers.begin(), numbers.end());
    for (int i = 1; i < count; ++i) numbers.Add(one.begin(), one.end());
  };
  const auto view = [&](uint32_t width, uint32_t height, uint32_t fps) {
    Viewer viewer(*viewers_, "city", width, height,
                  [&](v1::Hello& hello) { hello.mutable_settings()->mutable_stream()->set_max_fps(fps); });
    return viewer.end();
  };
  const auto shot = [&](uint32_t width, uint32_t samples) {
    v1::RenderRequest request;
    request.set_world("city");
    request.set_width(width);
    request.set_height(64);
    request.set_samples(samples);
    grpc::ClientContext context;
    const auto stream = renders_->Render(&context, request);
    for (v1::RenderEvent event; stream->Read(&event);) {}
    Ended ended;
    ended.status = stream->Finish();
    ended.detail = detailOf(context);
    return ended;
  };
  constexpr auto kLimit = Code::RESOURCE_EXHAUSTED, kRange = Code::INVALID_ARGUMENT;
  const std::map<std::string, std::function<void()>> cases = {
      {"max_worlds",
       [&] {
         makeWorld("second");
         v1::CreateWorldRequest request;
         request.mutable_gltf()->set_path("triangle.gltf");
         v1::World world;
         expectFailure(call(&v1::WorldService::Stub::CreateWorld, request, world), kLimit, v1::ERROR_REASON_LIMIT,
                       "world", "2");
       }},
      {"max_viewers",
       [&] {
         Viewer first(*viewers_, "city", 64, 32), second(*viewers_, "city", 64, 32);
         first.welcome();
         second.welcome();
         expectFailure(view(64, 32, 30), kLimit, v1::ERROR_REASON_LIMIT, "viewers", "2");
         expectFailure(shot(64, 1), kLimit, v1::ERROR_REASON_LIMIT, "viewers", "2");
       }},
      {"max_instances",
       [&] {
         v1::ApplyEditsResponse answer;
         const uint64_t before = seqOf("city");
         auto fitting = buildRequest("city", "fitting", 1);
         placements(fitting, 8);
         ASSERT_TRUE(apply(fitting, answer).status.ok());
         const auto refused = edit([&](auto& r) { placements(r, 8); });
         EXPECT_EQ(refused.status.error_code(), kLimit);
         EXPECT_EQ(refused.detail.limit(), "10");
         EXPECT_EQ(seqOf("city"), before + 1);
       }},
      {"max_edits_per_call",
       [&] {
         const auto six = [](auto& r) {
           while (r.edits_size() < 6) *r.add_edits() = r.edits(0);
         };
         expectFailure(edit(six), kLimit, v1::ERROR_REASON_LIMIT, "edits", "5");
       }},
      {"max_placements_per_call",
       [&] {
         const auto refused = edit([&](auto& r) { placements(r, 9); });
         EXPECT_EQ(refused.status.error_code(), kLimit);
         EXPECT_EQ(refused.detail.limit(), "8");
       }},
      {"max_request_bytes",
       [&] { EXPECT_EQ(edit([&](auto& r) { placements(r, 3200); }).status.error_code(), kLimit); }},
      {"min_size",
       [&] {
         expectFailure(view(64, 15, 30), kRange, v1::ERROR_REASON_INVALID_FIELD, "settings.height", "[16, 128]");
         expectFailure(shot(15, 1), kRange, v1::ERROR_REASON_INVALID_FIELD, "request.width", "[16, 128]");
       }},
      {"max_size",
       [&] {
         expectFailure(view(129, 32, 30), kRange, v1::ERROR_REASON_INVALID_FIELD, "settings.width", "[16, 128]");
         expectFailure(shot(129, 1), kRange, v1::ERROR_REASON_INVALID_FIELD, "request.width", "[16, 128]");
       }},
      {"max_fps",
       [&] {
         expectFailure(view(64, 32, 61), kRange, v1::ERROR_REASON_INVALID_FIELD, "settings.stream.max_fps", "[1, 60]");
       }},
      {"max_shot_samples",
       [&] { expectFailure(shot(64, 8), kRange, v1::ERROR_REASON_INVALID_FIELD, "request.samples", "[1, 7]"); }},
  };
  const auto* fields = v1::ServerLimits::descriptor();
  for (int i = 0; i < fields->field_count(); ++i) {
    const auto* field = fields->field(i);
    SCOPED_TRACE(field->name());
    const auto found = cases.find(field->name());
    ASSERT_NE(found, cases.end()) << "nothing shows that this limit is held";
    EXPECT_TRUE(info.limits().GetReflection()->HasField(info.limits(), field)) << "it is not told";
    found->second();
    eventually([&] { return renderer_.views() == 0; }, "every view is freed");
  }
  expectServing("city");
}

TEST_F(LimitsTest, LengthOfANameAndOfARequestId) {
  makeWorld("city");
  const uint32_t most = service::Limits{}.max_name_length;
  for (const bool fits : {true, false}) {
    const std::string name(most + (fits ? 0 : 1), 'x');
    v1::CreateWorldRequest request;
    request.set_world(name);
    request.mutable_gltf()->set_path("triangle.gltf");
    v1::World world;
    EXPECT_EQ(call(&v1::WorldService::Stub::CreateWorld, request, world).status.error_code(),
              fits ? Code::OK : Code::INVALID_ARGUMENT);
    v1::ApplyEditsResponse answer;
    EXPECT_EQ(apply(buildRequest("city", name, 1), answer).status.error_code(),
              fits ? Code::OK : Code::INVALID_ARGUMENT);
  }
}

TEST_F(ServiceTest, MetricsTellOfEverybodyAndOfNobody) {
  makeWorld("secret-world");
  expectServing("secret-world");
  v1::ApplyEditsResponse answer;
  ASSERT_TRUE(apply(buildRequest("secret-world", "1", 1), answer).status.ok());
  v1::GetWorldRequest unknown;
  unknown.set_world("nowhere");
  v1::World world;
  call(&v1::WorldService::Stub::GetWorld, unknown, world);
  std::string text;
  eventually(
      [&] {
        text = server_->metrics();
        return text.find(R"(method="ViewerService.Attach")") != text.npos;
      },
      "the viewer's call has ended");
  for (const char* line :
       {"heliograph_worlds{state=\"ready\"} 1", "heliograph_ready 1", "heliograph_edits_total 2",
        "heliograph_calls_total{", "code=\"NOT_FOUND\"", "heliograph_frames_total ", "heliograph_tick_seconds_count ",
        "heliograph_resident_memory_bytes ", "heliograph_build_info{version=\"test\"} 1"})
    EXPECT_THAT(text, testing::HasSubstr(line));
  EXPECT_THAT(text, testing::Not(testing::HasSubstr("secret-world")));
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);)
    EXPECT_TRUE(line.empty() || line[0] == '#' || line.rfind("heliograph_", 0) == 0) << line;
}

}  // namespace
}  // namespace helio::test
