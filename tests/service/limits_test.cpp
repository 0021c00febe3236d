// Every limit that is not tested beside what it limits.
#include <fstream>
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
