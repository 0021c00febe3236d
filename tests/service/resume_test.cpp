// Viewers that come back, viewers that fall silent, and how much of a connection they take.
#include <thread>

#include "fixture.h"

namespace helio::test {
namespace {

using namespace std::chrono_literals;
using Code = grpc::StatusCode;

class ResumeTest : public ServiceTest {
 protected:
  ResumeTest() { again(30); }

  void again(uint32_t resume_seconds, const std::function<void(service::Limits&)>& adjust = {}) {
    restart([&](service::ServerConfig& config) {
      config.limits.resume_seconds = resume_seconds;
      if (adjust) adjust(config.limits);
    });
    makeWorld("city");
  }

  std::unique_ptr<Viewer> attach(const std::string& resume_token = {}) {
    return std::make_unique<Viewer>(*viewers_, "city", 64, 32, [&](v1::Hello& hello) {
      hello.set_resume_token(resume_token);
      // A busy machine's delays are no queue.
      hello.mutable_settings()->mutable_stream()->set_max_latency_ms(60'000);
    });
  }
};

TEST_F(ResumeTest, ABrokenViewerComesBackToItsHistory) {
  auto viewer = attach();
  const auto welcome = viewer->welcome();
  EXPECT_FALSE(welcome.resumed());
  EXPECT_EQ(welcome.resume_token().size(), 16u);
  const auto before = viewer->frameWhere([](const v1::Frame& f) { return f.telemetry().accumulated() >= 5; });
  viewer->cancel();
  viewer.reset();
  std::this_thread::sleep_for(100ms);
  EXPECT_EQ(renderer_.views(), 1u) << "nothing waits for its return";

  viewer = attach(welcome.resume_token());
  const auto back = viewer->welcome();
  EXPECT_TRUE(back.resumed());
  EXPECT_EQ(back.resume_token(), welcome.resume_token());
  EXPECT_GT(viewer->frame().telemetry().accumulated(), before.telemetry().accumulated());
  EXPECT_EQ(renderer_.views(), 1u);
  // And again: the same token holds as long as the viewer does.
  viewer->cancel();
  viewer = attach(welcome.resume_token());
  EXPECT_TRUE(viewer->welcome().resumed());
  viewer->frame();
}

TEST_F(ResumeTest, AGhostIsSuperseded) {
  auto ghost = attach();
  const auto welcome = ghost->welcome();
  const auto seen = ghost->frame();
  auto viewer = attach(welcome.resume_token());
  EXPECT_TRUE(viewer->welcome().resumed());
  EXPECT_GT(viewer->frame().telemetry().accumulated(), seen.telemetry().accumulated());
  std::vector<v1::Notice> notices;
  expectFailure(ghost->end(&notices), Code::ABORTED, v1::ERROR_REASON_SUPERSEDED, "");
  ASSERT_EQ(notices.size(), 1u);
  EXPECT_EQ(notices[0].kind(), v1::NOTICE_KIND_SUPERSEDED);
  eventually([&] { return renderer_.views() == 1; }, "there is one view");
  viewer->frame();
}

TEST_F(ResumeTest, AnUnknownTokenMakesANewViewer) {
  for (const std::string& token : {std::string(16, 'x'), std::string("short"), std::string(1000, 'y')}) {
    auto viewer = attach(token);
    EXPECT_FALSE(viewer->welcome().resumed());
    EXPECT_GE(viewer->frame().id(), 1u);
  }
}

TEST_F(ResumeTest, WhoSaysFarewellIsNotWaitedFor) {
  auto viewer = attach();
  const auto token = viewer->welcome().resume_token();
  viewer->frame();
  viewer->halfClose();
  EXPECT_TRUE(viewer->end().status.ok());
  eventually([&] { return renderer_.views() == 0; }, "its view is freed");
  EXPECT_FALSE(attach(token)->welcome().resumed());
}

TEST_F(ResumeTest, NobodyIsWaitedForLongerThanTheLimit) {
  again(1);
  auto viewer = attach();
  const auto token = viewer->welcome().resume_token();
  viewer->frame();
  viewer->cancel();
  eventually([&] { return renderer_.views() == 0; }, "its view is freed");
  EXPECT_FALSE(attach(token)->welcome().resumed());
}

TEST_F(ResumeTest, WhoIsWaitedForGivesWayToWhoIsHere) {
  again(30, [](service::Limits& limits) { limits.max_viewers = 1; });
  auto gone = attach();
  const auto token = gone->welcome().resume_token();
  gone->frame();
  // Its own place is no obstacle, whether or not the server has noticed that it went.
  auto back = attach(token);
  EXPECT_TRUE(back->welcome().resumed());
  back->frame();
  gone->end();
  back->cancel();
  back->end();
  eventually(
      [&] {
        auto other = attach();
        v1::ServerMessage message;
        return other->read(message) && message.has_welcome();
      },
      "another viewer has the place");
}

TEST_F(ResumeTest, EditsWhileItWasAwayAreInTheNextPicture) {
  auto viewer = attach();
  const auto token = viewer->welcome().resume_token();
  viewer->frame();
  viewer->cancel();
  viewer.reset();
  v1::ApplyEditsResponse answer;
  ASSERT_TRUE(apply(buildRequest("city", "while away", 1), answer).status.ok());
  viewer = attach(token);
  EXPECT_TRUE(viewer->welcome().resumed());
  EXPECT_GE(viewer->frame().applied_seq(), answer.seq());
}

TEST_F(ResumeTest, AWorldThatMovedSaysSo) {
  v1::ResolveRequest where;
  v1::ResolveResponse here;
  where.set_world("city");
  ASSERT_TRUE(call(&v1::WorldService::Stub::Resolve, where, here).status.ok());
  EXPECT_EQ(here.endpoint(), "");
  EXPECT_GE(here.epoch(), 1u);
  EXPECT_GT(here.ttl(), 0u);
  auto viewer = attach();
  viewer->frame();
  ASSERT_TRUE(log_->acquire("city").ok());  // another server takes it over
  v1::ApplyEditsResponse answer;
  const auto refused = apply(buildRequest("city", "too late", 1), answer);
  expectFailure(refused, Code::UNAVAILABLE, v1::ERROR_REASON_FENCED, "world");
  EXPECT_GT(refused.detail.retry_after_ms(), 0u);
  std::vector<v1::Notice> notices;
  expectFailure(viewer->end(&notices), Code::UNAVAILABLE, v1::ERROR_REASON_FENCED, "world");
  ASSERT_EQ(notices.size(), 1u);
  EXPECT_EQ(notices[0].kind(), v1::NOTICE_KIND_MOVED);
  expectFailure(call(&v1::WorldService::Stub::Resolve, where, here), Code::UNAVAILABLE, v1::ERROR_REASON_FENCED,
                "world");
  where.set_world("nowhere");
  expectFailure(call(&v1::WorldService::Stub::Resolve, where, here), Code::NOT_FOUND, v1::ERROR_REASON_UNKNOWN_WORLD,
                "world");
}

TEST_F(ResumeTest, ResolveNamesTheAdvertisedAddress) {
  restart([](service::ServerConfig& config) { config.advertise = "world.example:7700"; });
  makeWorld("city");
  v1::ResolveRequest where;
  v1::ResolveResponse here;
  where.set_world("city");
  ASSERT_TRUE(call(&v1::WorldService::Stub::Resolve, where, here).status.ok());
  EXPECT_EQ(here.endpoint(), "world.example:7700");
}

TEST_F(ResumeTest, AViewerThatFallsSilentIsEnded) {
  again(0, [](service::Limits& limits) { limits.max_silence_seconds = 1; });
  Viewer silent(*viewers_, "city", 64, 32), other(*viewers_, "city", 64, 32);
  silent.welcome();
  other.welcome();
  eventually(
      [&] {
        other.frame();
        return renderer_.views() == 1;
      },
      "the silent viewer's view is freed");
  expectFailure(silent.end(), Code::UNAVAILABLE, v1::ERROR_REASON_SILENT, "", "1 s");
  EXPECT_THAT(server_->metrics(), testing::HasSubstr("heliograph_viewers_timed_out_total 1"));
}

TEST_F(ResumeTest, AStillCameraGetsASharperPicture) {
  auto viewer = attach();
  viewer->look(1, 5);
  const auto moving = viewer->frameWhere([](const v1::Frame& f) { return f.camera_id() == 1; });
  EXPECT_FALSE(moving.still());
  EXPECT_EQ(moving.telemetry().jpeg_quality(), 80u);
  const auto still = viewer->frameWhere([](const v1::Frame& f) { return f.still(); });
  EXPECT_EQ(still.telemetry().jpeg_quality(), 95u);
  viewer->look(2, 5);  // the same place: it still stands still
  EXPECT_TRUE(viewer->frameWhere([](const v1::Frame& f) { return f.camera_id() == 2; }).still());
  viewer->look(3, 6);
  EXPECT_FALSE(viewer->frameWhere([](const v1::Frame& f) { return f.camera_id() == 3; }).still());
}

TEST_F(ResumeTest, AViewerTakesNoMoreThanItWishes) {
  Viewer viewer(*viewers_, "city", 512, 256, [](v1::Hello& hello) {  // noise: 100 kB a frame
    hello.mutable_settings()->mutable_stream()->set_max_kbps(1'000);
  });
  // How much a wish is worth is tested in simulated time (tests/stream); here, that it gets there.
  const uint32_t first = viewer.frame().telemetry().jpeg_quality();
  uint32_t least = first;
  for (int i = 0; i < 10 && least == first; ++i) least = std::min(least, viewer.frame().telemetry().jpeg_quality());
  EXPECT_LT(least, 80u);
}

}  // namespace
}  // namespace helio::test
