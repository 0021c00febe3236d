// Viewers: who sees what, who is slow, who vanishes, who is wrong.
#include <turbojpeg.h>

#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <thread>

#include "fixture.h"
#include "render/light_switches.h"

namespace helio::test {
namespace {

using namespace std::chrono_literals;
using Code = grpc::StatusCode;

std::array<uint8_t, 3> middlePixel(const v1::Frame& frame) {
  const tjhandle handle = tjInitDecompress();
  std::vector<uint8_t> rgb(size_t{frame.width()} * frame.height() * 3);
  const auto* bytes = reinterpret_cast<const unsigned char*>(frame.data().data());
  EXPECT_EQ(tjDecompress2(handle, bytes, frame.data().size(), rgb.data(), int(frame.width()), 0, int(frame.height()),
                          TJPF_RGB, 0),
            0);
  tjDestroy(handle);
  const size_t i = (size_t{frame.height() / 2} * frame.width() + frame.width() / 2) * 3;
  return {rgb[i], rgb[i + 1], rgb[i + 2]};
}

class ViewerTest : public ServiceTest {
 protected:
  void SetUp() override { makeWorld("city"); }

  uint64_t droppedOf(uint64_t viewer) {
    grpc::ClientContext context;
    const auto stream = telemetry_->Watch(&context, v1::WatchTelemetryRequest());
    v1::TelemetrySample sample;
    EXPECT_TRUE(stream->Read(&sample));
    for (const auto& status : sample.worlds(0).viewers())
      if (status.viewer() == viewer) return status.dropped();
    ADD_FAILURE() << "viewer " << viewer << " is not in the telemetry";
    return 0;
  }
};

TEST_F(ViewerTest, TwoViewersOfOneWorldSeeTheirOwnSizesAndCameras) {
  Viewer left(*viewers_, "city", 64, 32), right(*viewers_, "city", 160, 96);
  EXPECT_EQ(left.welcome().world(), "city");
  EXPECT_NE(right.welcome().viewer(), 0u);
  left.look(1, 40, 111);
  right.look(7, 200, 222);
  const auto a = left.frameWhere([](const v1::Frame& f) { return f.camera_id() == 1; });
  const auto b = right.frameWhere([](const v1::Frame& f) { return f.camera_id() == 7; });
  EXPECT_EQ(a.width(), 64u);
  EXPECT_EQ(a.height(), 32u);
  EXPECT_EQ(b.width(), 160u);
  EXPECT_EQ(b.height(), 96u);
  EXPECT_EQ(a.camera_client_ns(), 111u);
  EXPECT_EQ(b.camera_client_ns(), 222u);
  EXPECT_NEAR(middlePixel(a)[2], 40, 4);
  EXPECT_NEAR(middlePixel(b)[2], 200, 4);
  EXPECT_EQ(a.telemetry().passes(0).name(), "paint");
  EXPECT_EQ(a.telemetry().rays().primary(), 64u * 32u);
  EXPECT_EQ(a.telemetry().nonfinite(), 5u);
  ASSERT_EQ(a.telemetry().dropped_samples_size(), 2);
  EXPECT_EQ(a.telemetry().dropped_samples(1).pass(), "paint");
  EXPECT_EQ(a.telemetry().dropped_samples(1).cause(), "negative");
  EXPECT_EQ(a.telemetry().dropped_samples(1).samples(), 3u);
}

TEST_F(ViewerTest, FramesOfOneStreamAscend) {
  Viewer viewer(*viewers_, "city", 64, 32);
  v1::Frame last;
  for (int i = 0; i < 20; ++i) {
    const auto frame = viewer.frame();
    EXPECT_EQ(frame.id(), last.id() + 1);
    EXPECT_GT(frame.tick(), last.tick());
    EXPECT_GE(frame.telemetry().time(), last.telemetry().time());
    last = frame;
  }
}

TEST_F(ViewerTest, WithoutAcknowledgementsTwoFramesAreOnTheirWayAndNoMore) {
  Viewer viewer(*viewers_, "city", 64, 32);
  viewer.welcome();
  v1::ServerMessage message;
  ASSERT_TRUE(viewer.read(message) && message.has_frame());
  ASSERT_TRUE(viewer.read(message) && message.has_frame());
  EXPECT_EQ(message.frame().id(), 2u);
  std::this_thread::sleep_for(200ms);
  const uint64_t ticks = renderer_.ticks();
  std::this_thread::sleep_for(300ms);
  EXPECT_LE(renderer_.ticks(), ticks + 1) << "frames are rendered that nobody can get";
  viewer.acknowledge(2);
  ASSERT_TRUE(viewer.read(message));
  EXPECT_EQ(message.frame().id(), 3u);
}

TEST_F(ViewerTest, ASlowReaderHoldsAFewPicturesAndSlowsNobody) {
  // It acknowledges at once, so that its window stays open, and reads nothing: what the connection buffers is soon
  // full.
  Viewer slow(*viewers_, "city", 512, 512, [](v1::Hello& hello) {
    hello.mutable_settings()->mutable_stream()->set_jpeg_quality(100);
    hello.mutable_settings()->mutable_stream()->set_max_latency_ms(60'000);
  });
  const uint64_t slow_id = slow.welcome().viewer();
  Viewer fast(*viewers_, "city", 64, 32);
  fast.welcome();
  for (int i = 0; i < 100; ++i) {
    fast.frame();
    // Whatever has been sent by now: acknowledgements of frames that are not on their way are ignored.
    for (uint64_t id = 1; id < 40; ++id) slow.acknowledge(id);
  }
  // A picture in the mailbox, one in the encoder and one in the tick, for each of two viewers.
  EXPECT_LE(renderer_.mostPixels(), 6);
  EXPECT_GT(droppedOf(slow_id), 0u) << "it was not slow";
  slow.cancel();
  eventually([&] { return renderer_.views() == 1; }, "the slow reader's view is freed");
  expectServing("city");
}

TEST_F(ViewerTest, AVanishedClientFreesItsView) {
  {
    Viewer viewer(*viewers_, "city", 64, 32);
    viewer.frame();
    EXPECT_EQ(renderer_.views(), 1u);
    viewer.cancel();
    eventually([&] { return renderer_.views() == 0; }, "the view is freed");
  }
  expectServing("city");
}

TEST_F(ViewerTest, AClientThatHasNothingMoreToSayEndsInOrder) {
  Viewer viewer(*viewers_, "city", 64, 32);
  viewer.frame();
  viewer.halfClose();
  EXPECT_TRUE(viewer.end().status.ok());
  eventually([&] { return renderer_.views() == 0; }, "the view is freed");
}

TEST_F(ViewerTest, NobodyLooksNothingTicks) {
  const uint64_t ticks = renderer_.ticks();
  std::this_thread::sleep_for(200ms);
  EXPECT_EQ(renderer_.ticks(), ticks);
}

TEST_F(ViewerTest, APausedViewerGetsNothingUntilItGoesOn) {
  Viewer viewer(*viewers_, "city", 64, 32, [](v1::Hello& hello) { hello.mutable_settings()->set_paused(true); });
  EXPECT_TRUE(viewer.welcome().settings().settings().paused());
  std::this_thread::sleep_for(200ms);
  EXPECT_EQ(renderer_.ticks(), 0u);
  viewer.settings(2, 64, 32);
  EXPECT_EQ(viewer.frame().id(), 1u);
}

TEST_F(ViewerTest, AMaterialOverrideIsASettingLikeOthers) {
  Viewer viewer(*viewers_, "city", 64, 32,
                [](v1::Hello& hello) { hello.mutable_settings()->set_materials(v1::MATERIAL_OVERRIDE_NORMALS); });
  EXPECT_EQ(viewer.welcome().settings().settings().materials(), v1::MATERIAL_OVERRIDE_NORMALS);
  viewer.frame();
  EXPECT_EQ(renderer_.newestSettings().materials, render::MaterialOverride::normals);
}

TEST_F(ViewerTest, SwitchesOfLightTransportAreSettingsLikeOthers) {
  const render::ViewSettings usual;
  for (const auto& each : render::kLightSwitches) {
    SCOPED_TRACE(each.name);
    const auto* field = v1::LightTransport::descriptor()->FindFieldByName(each.name);
    ASSERT_NE(field, nullptr);
    eventually([&] { return renderer_.views() == 0; }, "nobody else looks");
    Viewer viewer(*viewers_, "city", 64, 32, [&](v1::Hello& hello) {
      auto& light = *hello.mutable_settings()->mutable_light_transport();
      light.GetReflection()->SetBool(&light, field, !(usual.*each.field));
    });
    // What was not said is the default, and said; the switch reaches the renderer.
    const v1::LightTransport in_effect = viewer.welcome().settings().settings().light_transport();
    for (const auto& other : render::kLightSwitches) {
      const auto* named = v1::LightTransport::descriptor()->FindFieldByName(other.name);
      EXPECT_TRUE(in_effect.GetReflection()->HasField(in_effect, named)) << other.name;
      EXPECT_EQ(in_effect.GetReflection()->GetBool(in_effect, named), (usual.*other.field) != (named == field))
          << other.name;
    }
    viewer.frame();
    EXPECT_EQ(renderer_.newestSettings().*each.field, !(usual.*each.field));
  }
  eventually([&] { return renderer_.views() == 0; }, "nobody else looks");
  Viewer smoother(*viewers_, "city", 64, 32, [](v1::Hello& hello) {
    hello.mutable_settings()->mutable_light_transport()->set_regularisation(0.25f);
    hello.mutable_settings()->mutable_light_transport()->set_lamp_samples(4);
  });
  EXPECT_EQ(smoother.welcome().settings().settings().light_transport().regularisation(), 0.25f);
  smoother.frame();
  EXPECT_EQ(renderer_.newestSettings().regularisation, 0.25f);
  EXPECT_EQ(renderer_.newestSettings().lamp_samples, 4u);
}

TEST_F(ViewerTest, EveryFrameAfterTheAnswerHasTheNewSettings) {
  Viewer viewer(*viewers_, "city", 64, 32);
  viewer.frame();
  viewer.settings(5, 96, 48);
  v1::ServerMessage message;
  do ASSERT_TRUE(viewer.read(message));
  while (!message.has_settings());
  const auto& settings = message.settings().settings();
  EXPECT_EQ(settings.revision(), 5u);
  EXPECT_EQ(settings.width(), 96u);
  EXPECT_EQ(settings.bounces(), 3u) << "defaults are filled in";
  EXPECT_EQ(settings.stream().jpeg_quality(), 80u);
  for (int i = 0; i < 5; ++i) EXPECT_EQ(viewer.frame().width(), 96u);
}

TEST_F(ViewerTest, UnknownWorld) {
  Viewer viewer(*viewers_, "atlantis", 64, 32);
  expectFailure(viewer.end(), Code::NOT_FOUND, v1::ERROR_REASON_UNKNOWN_WORLD, "world");
  expectServing("city");
}

TEST_F(ViewerTest, TheFirstMessageMustBeHelloAndTheOnlyOne) {
  Viewer viewer(*viewers_);
  viewer.look(1, 0);
  expectFailure(viewer.end(), Code::INVALID_ARGUMENT, v1::ERROR_REASON_INVALID_FIELD, "kind",
                "hello as the first message");
  Viewer twice(*viewers_, "city", 64, 32);
  v1::ViewerMessage hello;
  hello.mutable_hello()->set_world("city");
  twice.send(hello);
  expectFailure(twice.end(), Code::INVALID_ARGUMENT, v1::ERROR_REASON_INVALID_FIELD, "kind", "one hello a stream");
  expectServing("city");
}

TEST_F(ViewerTest, AMessageOfAnUnknownKindIsIgnored) {
  Viewer viewer(*viewers_, "city", 64, 32);
  viewer.send(v1::ViewerMessage());
  EXPECT_GE(viewer.frame().id(), 1u);
}

TEST_F(ViewerTest, SizesOutOfRange) {
  const std::tuple<uint32_t, uint32_t, const char*> cases[] = {{0, 0, "settings.width"},
                                                               {20'000, 20'000, "settings.width"},
                                                               {64, 0, "settings.height"},
                                                               {64, 8193, "settings.height"},
                                                               {15, 64, "settings.width"}};
  for (const auto& [width, height, field] : cases) {
    Viewer viewer(*viewers_, "city", width, height);
    expectFailure(viewer.end(), Code::INVALID_ARGUMENT, v1::ERROR_REASON_INVALID_FIELD, field, "[16, 8192]");
    EXPECT_EQ(renderer_.views(), 0u);
    // In the middle of a stream likewise.
    Viewer changing(*viewers_, "city", 64, 32);
    changing.frame();
    changing.settings(2, width, height);
    expectFailure(changing.end(), Code::INVALID_ARGUMENT, v1::ERROR_REASON_INVALID_FIELD, field, "[16, 8192]");
    eventually([&] { return renderer_.views() == 0; }, "the view is freed");
  }
  expectServing("city");
}

TEST_F(ViewerTest, SettingsOutOfRange) {
  using Adjust = std::function<void(v1::Settings&)>;
  const std::pair<const char*, Adjust> cases[] = {
      {"settings.bounces", [](v1::Settings& s) { s.set_bounces(33); }},
      {"settings.samples", [](v1::Settings& s) { s.set_samples(65); }},
      {"settings.materials", [](v1::Settings& s) { s.set_materials(v1::MaterialOverride(99)); }},
      {"settings.mode", [](v1::Settings& s) { s.set_mode(v1::RenderMode(99)); }},
      {"settings.primary", [](v1::Settings& s) { s.set_primary(v1::PrimaryHits(99)); }},
      {"settings.exposure_ev", [](v1::Settings& s) { s.mutable_exposure()->set_ev(std::nanf("")); }},
      {"settings.stream.max_fps", [](v1::Settings& s) { s.mutable_stream()->set_max_fps(61); }},
      {"settings.regularisation", [](v1::Settings& s) { s.mutable_light_transport()->set_regularisation(1.5f); }},
      {"settings.lamp_samples", [](v1::Settings& s) { s.mutable_light_transport()->set_lamp_samples(65); }},
      {"settings.approximations.sun_shadow",
       [](v1::Settings& s) { s.mutable_approximations()->set_sun_shadow(v1::SunShadow(99)); }},
      {"settings.approximations.denoiser",
       [](v1::Settings& s) { s.mutable_approximations()->set_denoiser(v1::Denoiser(99)); }},
      {"settings.extra_samples", [](v1::Settings& s) { s.mutable_approximations()->set_extra_samples(5.0f); }},
      {"settings.shadow_map_size", [](v1::Settings& s) { s.mutable_approximations()->set_shadow_map_size(100); }},
      {"settings.inspect", [](v1::Settings& s) { s.set_inspect(v1::Inspect(99)); }},
      {"settings.culling_view", [](v1::Settings& s) { s.set_culling_view(v1::CullingView(99)); }},
      {"settings.stream.jpeg_quality", [](v1::Settings& s) { s.mutable_stream()->set_jpeg_quality(101); }},
      {"settings.stream.max_latency_ms", [](v1::Settings& s) { s.mutable_stream()->set_max_latency_ms(5); }},
  };
  for (const auto& [field, adjust] : cases) {
    const Adjust& change = adjust;
    Viewer viewer(*viewers_, "city", 64, 32, [&](v1::Hello& hello) { change(*hello.mutable_settings()); });
    const auto ended = viewer.end();
    expectFailure(ended, Code::INVALID_ARGUMENT, v1::ERROR_REASON_INVALID_FIELD, field);
    EXPECT_FALSE(ended.detail.limit().empty()) << field;
  }
  expectServing("city");
}

TEST_F(ViewerTest, CamerasThatAreNone) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  const std::tuple<std::vector<float>, float, const char*> cases[] = {{{nan, 0, 0, 0, 0, 0, 1}, 1.0f, "camera.pose"},
                                                                      {{0, 0, 0, 0, 0, 0, inf}, 1.0f, "camera.pose"},
                                                                      {{0, 0, 0, 0, 0, 0, 0}, 1.0f, "camera.pose"},
                                                                      {{0, 0, 1e6f, 0, 0, 0, 1}, 1.0f, "camera.pose"},
                                                                      {{0, 0, 0}, 1.0f, "camera.pose"},
                                                                      {{}, 1.0f, "camera.pose"},
                                                                      {{0, 0, 0, 0, 0, 0, 1}, nan, "camera.vfov"},
                                                                      {{0, 0, 0, 0, 0, 0, 1}, 0.0f, "camera.vfov"},
                                                                      {{0, 0, 0, 0, 0, 0, 1}, 4.0f, "camera.vfov"}};
  for (const auto& [pose, vfov, field] : cases) {
    v1::Camera camera;
    camera.mutable_pose()->Add(pose.begin(), pose.end());
    camera.set_vfov(vfov);
    Viewer viewer(*viewers_, "city", 64, 32, [&](v1::Hello& hello) { *hello.mutable_camera() = camera; });
    expectFailure(viewer.end(), Code::INVALID_ARGUMENT, v1::ERROR_REASON_INVALID_FIELD, std::string("hello.") + field);
    Viewer moving(*viewers_, "city", 64, 32);
    v1::ViewerMessage message;
    *message.mutable_camera() = camera;
    moving.send(message);
    expectFailure(moving.end(), Code::INVALID_ARGUMENT, v1::ERROR_REASON_INVALID_FIELD, field);
  }
  expectServing("city");
}

TEST_F(ViewerTest, AClientWithoutJpeg) {
  Viewer viewer(*viewers_, "city", 64, 32, [](v1::Hello& hello) { hello.add_codecs(v1::CODEC_PNG); });
  expectFailure(viewer.end(), Code::INVALID_ARGUMENT, v1::ERROR_REASON_INVALID_FIELD, "hello.codecs");
}

TEST_F(ViewerTest, OneViewerTooMany) {
  restart([](service::ServerConfig& config) { config.limits.max_viewers = 2; });
  makeWorld("city");
  {
    Viewer first(*viewers_, "city", 64, 32), second(*viewers_, "city", 64, 32);
    first.frame();
    second.frame();
    Viewer third(*viewers_, "city", 64, 32);
    expectFailure(third.end(), Code::RESOURCE_EXHAUSTED, v1::ERROR_REASON_LIMIT, "viewers", "2");
    EXPECT_GE(first.frame().id(), 1u);
  }
  eventually([&] { return renderer_.views() == 0; }, "the places are free again");
  expectServing("city");
}

TEST_F(ViewerTest, AViewThatCannotBeRenderedEndsAloneAndLosesNoEdit) {
  Viewer good(*viewers_, "city", 64, 32);
  good.frame();
  renderer_.failWidth(112);
  Viewer bad(*viewers_, "city", 112, 32);
  const auto ended = bad.end();
  expectFailure(ended, Code::RESOURCE_EXHAUSTED, v1::ERROR_REASON_LIMIT, "memory");
  v1::ApplyEditsResponse answer;
  ASSERT_TRUE(apply(buildRequest("city", "after", 1), answer).status.ok());
  EXPECT_EQ(good.frameWhere([&](const v1::Frame& f) { return f.applied_seq() >= answer.seq(); }).width(), 64u);
}

TEST_F(ViewerTest, ALostDeviceIsToldToViewersAndToWhoMustEndTheProcess) {
  std::atomic<int> told = 0;
  restart([&](service::ServerConfig& config) {
    config.on_fatal = [&](const Error& error) { told += error.kind == ErrorKind::internal; };
  });
  makeWorld("city");
  Viewer viewer(*viewers_, "city", 64, 32);
  viewer.frame();
  renderer_.loseDevice();
  EXPECT_EQ(viewer.end().status.error_code(), Code::INTERNAL);
  eventually([&] { return told == 1; }, "the process is told to end");
}

TEST_F(ViewerTest, DeletingAWorldTellsItsViewers) {
  makeWorld("other");
  Viewer viewer(*viewers_, "city", 64, 32), elsewhere(*viewers_, "other", 64, 32);
  viewer.frame();
  elsewhere.frame();
  v1::DeleteWorldRequest request;
  request.set_world("city");
  v1::DeleteWorldResponse response;
  ASSERT_TRUE(call(&v1::WorldService::Stub::DeleteWorld, request, response).status.ok());
  std::vector<v1::Notice> notices;
  expectFailure(viewer.end(&notices), Code::NOT_FOUND, v1::ERROR_REASON_WORLD_DELETED, "world");
  ASSERT_EQ(notices.size(), 1u);
  EXPECT_EQ(notices[0].kind(), v1::NOTICE_KIND_WORLD_DELETED);
  EXPECT_GE(elsewhere.frame().id(), 1u);
  eventually([&] { return renderer_.worlds() == 1; }, "the world is freed");
  expectServing("other");
}

TEST_F(ViewerTest, DrainingTellsTheViewersAndEndsTheirStreams) {
  Viewer viewer(*viewers_, "city", 64, 32);
  viewer.frame();
  std::thread drain([&] { server_->drain(5s); });
  std::vector<v1::Notice> notices;
  const auto ended = viewer.end(&notices);
  expectFailure(ended, Code::UNAVAILABLE, v1::ERROR_REASON_DRAINING, "");
  EXPECT_GT(ended.detail.retry_after_ms(), 0u);
  ASSERT_EQ(notices.size(), 1u);
  EXPECT_EQ(notices[0].kind(), v1::NOTICE_KIND_DRAINING);
  drain.join();
}

TEST_F(ViewerTest, DrainingDoesNotWaitForAReaderThatReadsNothing) {
  Viewer slow(*viewers_, "city", 512, 512);
  slow.welcome();
  server_->drain(100ms);
  EXPECT_FALSE(slow.end().status.ok());
  eventually([&] { return renderer_.views() == 0; }, "the view is freed");
}

}  // namespace
}  // namespace helio::test
