// The true error of a live picture: what is measured, what goes on meanwhile, and what is refused.
#include "fixture.h"

namespace helio::test {
namespace {

using Code = grpc::StatusCode;

struct Measured {
  Ended ended;
  v1::AccuracyResult result;
  std::vector<v1::AccuracyProgress> progress;
  std::string pictures;
  bool has_result = false;
};

class AccuracyTest : public ServiceTest {
 protected:
  AccuracyTest() { makeWorld("city"); }

  static v1::MeasureAccuracyRequest own(uint32_t samples = 8) {
    v1::MeasureAccuracyRequest request;
    request.set_world("city");
    request.mutable_settings()->set_width(64);
    request.mutable_settings()->set_height(32);
    request.set_samples(samples);
    return request;
  }
  static v1::MeasureAccuracyRequest of(uint64_t viewer, uint32_t samples = 8) {
    v1::MeasureAccuracyRequest request;
    request.set_world("city");
    request.set_viewer(viewer);
    request.set_samples(samples);
    return request;
  }

  Measured measure(const v1::MeasureAccuracyRequest& request) {
    grpc::ClientContext context;
    const auto stream = renders_->MeasureAccuracy(&context, request);
    Measured measured;
    v1::AccuracyEvent event;
    while (stream->Read(&event)) {
      if (event.has_progress()) measured.progress.push_back(event.progress());
      if (event.has_result()) {
        EXPECT_FALSE(measured.has_result);
        measured.has_result = true;
        measured.result = event.result();
      }
      EXPECT_LE(event.chunk().data().size(), 256u << 10);
      measured.pictures += event.chunk().data();
    }
    measured.ended.status = stream->Finish();
    measured.ended.detail = detailOf(context);
    return measured;
  }
};

TEST_F(AccuracyTest, AViewersNextPictureIsJudgedWhileItsStreamGoesOn) {
  renderer_.setTickTime(std::chrono::milliseconds(3));
  Viewer viewer(*viewers_, "city", 96, 48, [](v1::Hello& hello) { hello.mutable_settings()->set_bounces(5); });
  const uint64_t id = viewer.welcome().viewer();
  viewer.frame();
  v1::ApplyEditsResponse answer;
  ASSERT_TRUE(apply(buildRequest("city", "first", 1), answer).status.ok());
  viewer.frameWhere([&](const v1::Frame& frame) { return frame.applied_seq() >= answer.seq(); });

  auto request = of(id, 64);
  request.set_pictures(true);
  grpc::ClientContext context;
  const auto stream = renders_->MeasureAccuracy(&context, request);
  v1::AccuracyEvent event;
  std::vector<uint32_t> samples;
  size_t frames_meanwhile = 0;
  v1::AccuracyResult result;
  std::string pictures;
  while (stream->Read(&event)) {
    if (event.has_progress()) {
      EXPECT_EQ(event.progress().wanted(), 64u);
      samples.push_back(event.progress().samples());
    }
    if (!event.has_result() && !event.has_chunk()) {
      viewer.frame();  // the stream goes on
      ++frames_meanwhile;
      if (frames_meanwhile == 3) { EXPECT_TRUE(apply(buildRequest("city", "second", 2), answer).status.ok()); }
    }
    if (event.has_result()) result = event.result();
    pictures += event.chunk().data();
  }
  const auto status = stream->Finish();
  ASSERT_TRUE(status.ok()) << status.error_message();
  EXPECT_TRUE(std::is_sorted(samples.begin(), samples.end()));
  ASSERT_FALSE(samples.empty());
  EXPECT_EQ(samples.back(), 64u);
  EXPECT_GE(frames_meanwhile, 3u);

  EXPECT_EQ(result.applied_seq(), 1u) << "the world as it was then, whatever was built meanwhile";
  EXPECT_GT(result.tick(), 0u);
  EXPECT_EQ(result.settings().width(), 96u);
  EXPECT_EQ(result.settings().bounces(), 5u);
  EXPECT_EQ(result.samples(), 64u);
  EXPECT_EQ(result.bounces(), 8u);
  // The painter's radiance is 0.5 everywhere, of both.
  EXPECT_EQ(result.relative_mse(), 0.0);
  EXPECT_EQ(result.reference_noise(), 0.0);
  EXPECT_FALSE(result.has_estimate()) << "without a denoiser nothing is believed";
  ASSERT_EQ(result.pictures_size(), 3);
  size_t begin = 0;
  for (const auto& picture : result.pictures()) {
    EXPECT_EQ(pictures.substr(begin + 1, 3), "PNG") << picture.name();
    begin += picture.size();
  }
  EXPECT_EQ(begin, pictures.size());
  eventually([&] { return renderer_.worlds() == 1 && renderer_.views() == 1; }, "the copy is gone");
  viewer.frame();
}

TEST_F(AccuracyTest, APictureOfItsOwnIsThatOfItsLastFrame) {
  auto request = own(6);
  request.set_frames(5);
  request.mutable_settings()->set_samples(2);
  request.set_bounces(3);
  const Measured measured = measure(request);
  ASSERT_TRUE(measured.ended.status.ok()) << measured.ended.status.error_message();
  ASSERT_TRUE(measured.has_result);
  EXPECT_EQ(measured.result.accumulated(), 10u) << "five frames of two samples";
  EXPECT_EQ(measured.result.bounces(), 3u);
  EXPECT_EQ(measured.result.pictures_size(), 0) << "nobody asked for them";
  EXPECT_EQ(measured.pictures, "");
  ASSERT_FALSE(measured.progress.empty());
  EXPECT_EQ(measured.progress.front().samples(), 0u) << "that it waits is said at once";
  eventually([&] { return renderer_.worlds() == 1 && renderer_.views() == 0; }, "nothing is left");
}

TEST_F(AccuracyTest, WhatTheServerBelievedIsPartOfTheResult) {
  renderer_.setCostOfPaths(0.1);
  auto request = own();
  request.mutable_settings()->mutable_approximations()->set_denoiser(v1::DENOISER_SVGF);
  const Measured measured = measure(request);
  ASSERT_TRUE(measured.has_result) << measured.ended.status.error_message();
  EXPECT_GT(measured.result.estimate().variance(), 0.0f);
  EXPECT_GT(measured.result.estimate().bias(), 0.0f);
}

TEST_F(AccuracyTest, WhatCannotBeMeasuredIsNamed) {
  restart([](service::ServerConfig& config) { config.limits.max_accuracy_pixels = 64 * 32; });
  makeWorld("city");
  const auto fails = [&](const std::function<void(v1::MeasureAccuracyRequest&)>& adjust, Code code,
                         v1::ErrorReason reason, const char* field, const std::string& limit = {}) {
    SCOPED_TRACE(field);
    auto request = own();
    adjust(request);
    const Measured measured = measure(request);
    EXPECT_FALSE(measured.has_result);
    expectFailure(measured.ended, code, reason, field, limit);
    EXPECT_EQ(renderer_.worlds(), 1u);
  };
  const auto invalid = v1::ERROR_REASON_INVALID_FIELD;
  fails([](auto& r) { r.set_world("atlantis"); }, Code::NOT_FOUND, v1::ERROR_REASON_UNKNOWN_WORLD, "world");
  fails([](auto& r) { r.set_viewer(77); }, Code::NOT_FOUND, v1::ERROR_REASON_UNKNOWN_NAME, "request.viewer");
  fails([](auto& r) { r.set_camera_name("none"); }, Code::NOT_FOUND, v1::ERROR_REASON_UNKNOWN_NAME,
        "request.camera_name");
  fails([](auto& r) { r.mutable_camera(); }, Code::INVALID_ARGUMENT, invalid, "request.camera.pose");
  fails([](auto& r) { r.set_samples(1); }, Code::INVALID_ARGUMENT, invalid, "request.samples", "[2, 65536]");
  fails([](auto& r) { r.set_bounces(33); }, Code::INVALID_ARGUMENT, invalid, "request.bounces", "[0, 32]");
  fails([](auto& r) { r.set_frames(2000); }, Code::INVALID_ARGUMENT, invalid, "request.frames", "[1, 1024]");
  fails([](auto& r) { r.mutable_settings()->set_width(0); }, Code::INVALID_ARGUMENT, invalid, "settings.width");
  fails([](auto& r) { r.mutable_settings()->set_materials(v1::MATERIAL_OVERRIDE_NORMALS); }, Code::INVALID_ARGUMENT,
        invalid, "request.view");
  fails([](auto& r) { r.mutable_settings()->set_inspect(v1::INSPECT_MOTION); }, Code::INVALID_ARGUMENT, invalid,
        "request.view");
  fails([](auto& r) { r.mutable_settings()->set_height(33); }, Code::RESOURCE_EXHAUSTED, v1::ERROR_REASON_LIMIT,
        "pixels", "2048");
  expectServing("city");
}

TEST_F(AccuracyTest, OneAtATimeAWorld) {
  renderer_.setTickTime(std::chrono::milliseconds(5));
  makeWorld("other");
  grpc::ClientContext context;
  const auto first = renders_->MeasureAccuracy(&context, own(60'000));
  v1::AccuracyEvent event;
  ASSERT_TRUE(first->Read(&event));
  expectFailure(measure(own()).ended, Code::RESOURCE_EXHAUSTED, v1::ERROR_REASON_LIMIT, "world", "1");
  auto elsewhere = own();
  elsewhere.set_world("other");
  EXPECT_TRUE(measure(elsewhere).ended.status.ok()) << "another world is another matter";

  while (event.progress().samples() == 0) ASSERT_TRUE(first->Read(&event));
  context.TryCancel();
  EXPECT_EQ(first->Finish().error_code(), Code::CANCELLED);
  eventually([&] { return renderer_.worlds() == 2 && renderer_.views() == 0; }, "the copy is gone");
  Measured again;
  eventually([&] { return (again = measure(own())).ended.status.error_code() != Code::RESOURCE_EXHAUSTED; },
             "the next may begin");
  EXPECT_TRUE(again.ended.status.ok()) << again.ended.status.error_message();
}

TEST_F(AccuracyTest, EndsWithItsWorld) {
  renderer_.setTickTime(std::chrono::milliseconds(5));
  grpc::ClientContext context, deleting;
  const auto stream = renders_->MeasureAccuracy(&context, own(60'000));
  v1::AccuracyEvent event;
  while (event.progress().samples() == 0) ASSERT_TRUE(stream->Read(&event));
  v1::DeleteWorldRequest request;
  request.set_world("city");
  v1::DeleteWorldResponse answer;
  ASSERT_TRUE(worlds_->DeleteWorld(&deleting, request, &answer).ok());
  while (stream->Read(&event)) {}
  Ended ended;
  ended.status = stream->Finish();
  ended.detail = detailOf(context);
  EXPECT_EQ(ended.detail.reason(), v1::ERROR_REASON_WORLD_DELETED) << ended.status.error_message();
  eventually([&] { return renderer_.worlds() == 0; }, "world and copy are gone");
}

TEST_F(AccuracyTest, AViewerThatLeavesBeforeItsPictureIsNamed) {
  Viewer viewer(*viewers_, "city", 64, 32, [](v1::Hello& hello) { hello.mutable_settings()->set_paused(true); });
  const uint64_t id = viewer.welcome().viewer();
  grpc::ClientContext context;
  const auto stream = renders_->MeasureAccuracy(&context, of(id));
  v1::AccuracyEvent event;
  ASSERT_TRUE(stream->Read(&event));
  EXPECT_EQ(event.progress().samples(), 0u);
  viewer.halfClose();
  while (stream->Read(&event)) {}
  Ended ended;
  ended.status = stream->Finish();
  ended.detail = detailOf(context);
  expectFailure(ended, Code::NOT_FOUND, v1::ERROR_REASON_UNKNOWN_NAME, "request.viewer");
  viewer.end();
}

}  // namespace
}  // namespace helio::test
