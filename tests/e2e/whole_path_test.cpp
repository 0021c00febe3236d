// The whole path in one process: a real renderer, a server on loopback, and the client library.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "lib/camera.h"
#include "lib/viewer_session.h"
#include "render/renderer.h"
#include "service/server.h"

namespace helio {
namespace {

namespace v1 = heliograph::v1;

class WholePath : public testing::Test {
 protected:
  void SetUp() override {
    render::RendererOptions options;
    options.device = std::getenv("HELIOGRAPH_DEVICE") ? "" : "cpu";
    options.strict_validation =
        std::getenv("HELIOGRAPH_TEST_WITHOUT_VALIDATION") == nullptr;  // the bundle has no layers
    auto renderer = render::makeRenderer(options);
    ASSERT_TRUE(renderer) << renderer.error().message;
    renderer_ = std::move(*renderer);
    service::ServerConfig config;
    config.address = "127.0.0.1:0";
    config.on_fatal = [](const Error& error) { ADD_FAILURE() << "fatal: " << error.message; };
    auto server = service::Server::start(std::move(config), *renderer_, *log_);
    ASSERT_TRUE(server) << server.error().message;
    server_ = std::move(*server);
    ASSERT_TRUE(server_->createCity("city", {1, 1000}));
    connection_ = std::make_unique<client::Connection>(server_->address());
    auto world = connection_->readyWorld("city");
    ASSERT_TRUE(world) << world.error().message;
    world_ = *world;
  }

  std::unique_ptr<client::ViewerSession> attach() {
    client::ViewerSession::Options options;
    options.world = "city";
    options.settings.set_width(160);
    options.settings.set_height(96);
    auto session = client::ViewerSession::attach(*connection_, options);
    EXPECT_TRUE(session) << session.error().message;
    return session ? std::move(*session) : nullptr;
  }

  /// The first frame for which `wanted` holds; the test fails when the stream ends instead.
  static v1::Frame frameWhere(client::ViewerSession& session, const std::function<bool(const v1::Frame&)>& wanted) {
    for (;;) {
      auto received = session.next();
      if (!received || !*received) {
        ADD_FAILURE() << (received ? "the stream ended" : received.error().message);
        return {};
      }
      session.shown(**received, client::Clock::now());
      if (wanted((*received)->frame)) return (*received)->frame;
    }
  }

  std::unique_ptr<render::Renderer> renderer_;
  std::unique_ptr<store::EditLog> log_ = store::makeMemoryEditLog();
  std::unique_ptr<service::Server> server_;
  std::unique_ptr<client::Connection> connection_;
  v1::World world_;
};

TEST_F(WholePath, AViewerFliesBuildsAndDestroys) {
  const auto session = attach();
  ASSERT_TRUE(session);
  const auto first = frameWhere(*session, [](const v1::Frame&) { return true; });
  EXPECT_EQ(first.width(), 160u);
  EXPECT_EQ(first.data().substr(0, 2), "\xff\xd8");
  EXPECT_GT(first.telemetry().rays().bounce(), 0u);
  EXPECT_GT(first.telemetry().gpu_ms(), 0.0f);
  EXPECT_GT(first.telemetry().passes_size(), 0);
  EXPECT_EQ(first.telemetry().nonfinite(), 0u);

  // Jump: the frame names the camera.
  const uint64_t camera = session->look(world_.cameras(world_.cameras_size() - 1).camera());
  frameWhere(*session, [&](const v1::Frame& f) { return f.camera_id() == camera; });

  // Build, and see one more instance in the acceleration structure; destroy, and see it gone.
  const auto prefabs = connection_->prefabs("city");
  ASSERT_TRUE(prefabs);
  v1::ApplyEditsRequest request;
  request.set_world("city");
  auto& build = *request.add_edits()->mutable_build();
  for (const auto& prefab : *prefabs)
    if (prefab.buildable()) build.set_prefab(prefab.name());
  for (const float number : {0.0f, 5.0f, 0.0f, 0.0f, 0.0f, 0.0f, 1.0f, 1.0f}) build.add_placements(number);
  const auto built = connection_->apply(request);
  ASSERT_TRUE(built) << built.error().message;
  const auto with = frameWhere(*session, [&](const v1::Frame& f) { return f.applied_seq() >= built->seq(); });
  EXPECT_EQ(with.telemetry().tlas_instances(), first.telemetry().tlas_instances() + 1);

  request.Clear();
  request.set_world("city");
  request.add_edits()->mutable_destroy()->add_ids(built->built(0).first());
  const auto destroyed = connection_->apply(request);
  ASSERT_TRUE(destroyed) << destroyed.error().message;
  const auto without = frameWhere(*session, [&](const v1::Frame& f) { return f.applied_seq() >= destroyed->seq(); });
  EXPECT_EQ(without.telemetry().tlas_instances(), first.telemetry().tlas_instances());
}

TEST_F(WholePath, AShotAccumulatesLinearRadianceThatIsFinite) {
  v1::RenderRequest request;
  request.set_world("city");
  request.set_width(64);
  request.set_height(48);
  request.set_mode(v1::RENDER_MODE_REFERENCE);
  request.set_samples(8);
  request.set_codec(v1::CODEC_PFM);
  const auto picture = connection_->render(request, {});
  ASSERT_TRUE(picture) << picture.error().message;
  EXPECT_GE(picture->header.samples(), 8u);
  const std::string header = "PF\n64 48\n-1.0\n";
  ASSERT_EQ(picture->bytes.size(), header.size() + 64 * 48 * 3 * sizeof(float));
  double sum = 0;
  for (size_t i = header.size(); i < picture->bytes.size(); i += sizeof(float)) {
    float radiance;
    std::memcpy(&radiance, &picture->bytes[i], sizeof radiance);
    ASSERT_TRUE(std::isfinite(radiance) && radiance >= 0) << radiance;
    sum += radiance;
  }
  EXPECT_GT(sum, 0.0);
}

TEST_F(WholePath, TwoViewersOfTwoWorlds) {
  ASSERT_TRUE(server_->createCity("second", {2, 1000}));
  const auto one = attach();
  ASSERT_TRUE(one);
  client::ViewerSession::Options options;
  options.world = "second";
  options.settings.set_width(96);
  options.settings.set_height(64);
  auto two = client::ViewerSession::attach(*connection_, options);
  ASSERT_TRUE(two) << two.error().message;
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(frameWhere(*one, [](const v1::Frame&) { return true; }).width(), 160u);
    EXPECT_EQ(frameWhere(**two, [](const v1::Frame&) { return true; }).width(), 96u);
  }
}

}  // namespace
}  // namespace helio
