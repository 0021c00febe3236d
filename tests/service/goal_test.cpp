// Goals on the wire: what a viewer asks for, what the server makes of it, and what it says.
#include "fixture.h"
#include "render/ladder.h"

namespace helio::test {
namespace {

using Code = grpc::StatusCode;

class GoalTest : public ServiceTest {
 protected:
  GoalTest() {
    makeWorld("city");
    renderer_.setCostOfPaths(0.5);
  }
};

TEST_F(GoalTest, TheServerTakesWhatFitsAndSaysWhy) {
  // 1.5 ms that no preset changes; of rays 0.5, 1, 2, 4, 12 and 36 ms.
  Viewer viewer(*viewers_, "city", 64, 32, [](v1::Hello& hello) {
    hello.mutable_settings()->mutable_goal()->set_max_frame_ms(6.5f);
    hello.mutable_settings()->mutable_stream()->set_max_fps(60);
    hello.mutable_settings()->set_bounces(7);
  });
  EXPECT_FLOAT_EQ(viewer.welcome().settings().settings().goal().max_frame_ms(), 6.5f);
  const auto first = viewer.frame().telemetry();
  EXPECT_EQ(first.decision().preset(), "sketch") << "it begins with the quickest";
  EXPECT_EQ(first.decision().rungs(), render::kRungs);
  const auto frame = viewer.frameWhere([](const v1::Frame& f) { return f.telemetry().decision().rung() == 3; });
  const auto& decision = frame.telemetry().decision();
  EXPECT_EQ(decision.preset(), "rich");
  EXPECT_TRUE(decision.within_reach());
  EXPECT_NE(decision.reason().find("rich"), std::string::npos) << decision.reason();
  EXPECT_GT(decision.predicted_ms(), 0.0f);
  EXPECT_FLOAT_EQ(static_cast<float>(decision.measured_ms()), frame.telemetry().gpu_ms());
  EXPECT_NEAR(decision.scaling_ms(), 4.0, 1e-6);
  EXPECT_TRUE(decision.has_measured_variance());
  EXPECT_GT(frame.telemetry().error().variance(), 0.0f);
  EXPECT_GT(frame.telemetry().error().bias(), 0.0f);
  const auto rendered = renderer_.newestSettings();
  EXPECT_EQ(rendered.bounces, render::kLadder[3].bounces);
  EXPECT_EQ(rendered.samples, render::kLadder[3].samples);
  EXPECT_EQ(rendered.denoiser, render::Denoiser::svgf);

  // What fitted takes longer now: the next frames are quicker ones.
  renderer_.setCostOfPaths(1.0);
  const auto quicker = viewer.frameWhere([](const v1::Frame& f) { return f.telemetry().decision().rung() < 3; });
  EXPECT_NE(quicker.telemetry().decision().reason().find("took more than 6.5 ms"), std::string::npos)
      << quicker.telemetry().decision().reason();
}

TEST_F(GoalTest, AnotherGoalHoldsFromTheAnswerOnAndNoneIsTheSettingsAsTheyAre) {
  Viewer viewer(*viewers_, "city", 64, 32,
                [](v1::Hello& hello) { hello.mutable_settings()->mutable_goal()->set_max_error(1.0f); });
  EXPECT_EQ(viewer.frame().telemetry().decision().preset(), "sketch") << "any picture is that good";
  v1::ViewerMessage message;
  message.mutable_settings()->set_width(64);
  message.mutable_settings()->set_height(32);
  message.mutable_settings()->set_bounces(2);
  message.mutable_settings()->mutable_goal()->set_max_error(1e-6f);
  ASSERT_TRUE(viewer.send(message));
  const auto strict =
      viewer.frameWhere([](const v1::Frame& f) { return f.telemetry().decision().rung() + 1 == render::kRungs; });
  EXPECT_FALSE(strict.telemetry().decision().within_reach());
  message.mutable_settings()->clear_goal();
  ASSERT_TRUE(viewer.send(message));
  const auto plain = viewer.frameWhere([](const v1::Frame& f) { return !f.telemetry().has_decision(); });
  EXPECT_FALSE(plain.telemetry().has_error()) << "and no denoiser, which would know";
  EXPECT_EQ(renderer_.newestSettings().bounces, 2u);
  EXPECT_EQ(renderer_.newestSettings().samples, 1u);
}

TEST_F(GoalTest, GoalsThatAreNoneAreNamed) {
  const auto fails = [&](const std::function<void(v1::Settings&)>& adjust, const char* field) {
    Viewer viewer(*viewers_, "city", 64, 32, [&](v1::Hello& hello) { adjust(*hello.mutable_settings()); });
    expectFailure(viewer.end(), Code::INVALID_ARGUMENT, v1::ERROR_REASON_INVALID_FIELD, field);
  };
  fails([](auto& s) { s.mutable_goal(); }, "settings.goal");
  fails([](auto& s) { s.mutable_goal()->set_max_frame_ms(0.0f); }, "settings.goal.max_frame_ms");
  fails([](auto& s) { s.mutable_goal()->set_max_frame_ms(1e6f); }, "settings.goal.max_frame_ms");
  fails([](auto& s) { s.mutable_goal()->set_max_error(-1.0f); }, "settings.goal.max_error");
  fails(
      [](auto& s) {
        s.mutable_goal()->set_max_error(0.1f);
        s.set_mode(v1::RENDER_MODE_REFERENCE);
      },
      "settings.goal");
  expectServing("city");
}

}  // namespace
}  // namespace helio::test
