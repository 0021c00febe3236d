// The synthetic renderer: pictures say what they show, after the codec and after the whole path.
#include <turbojpeg.h>

#include <chrono>
#include <thread>

#include "fixture.h"
#include "service/synthetic_renderer.h"
#include "stream/jpeg.h"

namespace helio::test {
namespace {

using service::Painted;
using service::readPainted;

std::optional<Painted> readJpeg(const std::string& jpeg) {
  const tjhandle decoder = tjInitDecompress();
  int width = 0, height = 0, subsampling = 0, colourspace = 0;
  const auto* bytes = reinterpret_cast<const unsigned char*>(jpeg.data());
  std::vector<uint8_t> rgbx;
  if (tjDecompressHeader3(decoder, bytes, jpeg.size(), &width, &height, &subsampling, &colourspace) == 0) {
    rgbx.resize(size_t(width) * size_t(height) * 4);
    EXPECT_EQ(tjDecompress2(decoder, bytes, jpeg.size(), rgbx.data(), width, 0, height, TJPF_RGBX, 0), 0);
  }
  tjDestroy(decoder);
  return rgbx.empty() ? std::nullopt : readPainted({rgbx.data(), uint32_t(width), uint32_t(height)});
}

/// One frame of a new world.
render::Frame frameOf(render::Renderer& renderer, const render::ViewSettings& settings, const scene::Camera& camera,
                      uint64_t seq, uint64_t tick) {
  const auto world = renderer.addWorld(nullptr);
  const auto view = renderer.addView(*world);
  world::ChangeSet changes;
  changes.applied_seq = seq;
  changes.tick = tick;
  const render::ViewRequest request{*view, camera, settings};
  auto frames = renderer.tick(*world, changes, {&request, 1});
  EXPECT_TRUE(frames.ok()) << frames.error().message;
  return frames ? std::move(frames->front()) : render::Frame{};
}

TEST(SyntheticRenderer, PicturesAreReadableAfterJpegAtAnySizeQualityAndNoise) {
  stream::JpegEncoder encoder;
  for (const uint32_t noise : {0u, 40u})
    for (const auto& [width, height] : {std::pair{64u, 32u}, {160u, 90u}, {333u, 77u}, {90u, 600u}, {1280u, 720u}})
      for (const int quality : {20, 80, 95}) {
        const auto renderer = service::makeSyntheticRenderer({std::chrono::microseconds(0), noise});
        render::ViewSettings settings;
        settings.width = width;
        settings.height = height;
        scene::Camera camera;
        camera.position = {float(width), -1.5f, float(quality)};
        const auto frame = frameOf(*renderer, settings, camera, 0x1234567890u + width, 77 + uint64_t(quality));
        std::string jpeg;
        ASSERT_TRUE(encoder.encode(*frame.pixels, quality, jpeg).ok());
        const auto painted = readJpeg(jpeg);
        ASSERT_TRUE(painted) << width << "x" << height << " quality " << quality << " noise " << noise;
        EXPECT_EQ(painted->seq, uint32_t(0x1234567890u + width));
        EXPECT_EQ(painted->tick, 77u + uint32_t(quality));
        EXPECT_EQ(painted->camera, service::cameraCode(camera.position));
      }
}

TEST(SyntheticRenderer, APictureThatIsNoneIsNotRead) {
  std::vector<uint8_t> grey(160 * 90 * 4, 127);
  EXPECT_FALSE(readPainted({grey.data(), 160, 90}));
  EXPECT_FALSE(readPainted({grey.data(), 4, 4}));
}

TEST(SyntheticRenderer, TakesTheTimeThatItIsGiven) {
  const auto renderer = service::makeSyntheticRenderer({std::chrono::milliseconds(20), 0});
  const auto start = std::chrono::steady_clock::now();
  const auto frame = frameOf(*renderer, {}, {}, 1, 1);
  EXPECT_GE(std::chrono::steady_clock::now() - start, std::chrono::milliseconds(20));
  EXPECT_EQ(frame.stats.gpu_ms, 20.0);
}

TEST(SyntheticRenderer, RefusesWhatTheOthersRefuse) {
  const auto renderer = service::makeSyntheticRenderer({});
  const auto world = renderer->addWorld(nullptr);
  const auto view = renderer->addView(*world);
  render::ViewRequest request{*view, {}, {}};
  request.settings.width = 1;
  EXPECT_EQ(renderer->tick(*world, {}, {&request, 1}).error().kind, ErrorKind::invalid);
  EXPECT_FALSE(renderer->addView(999).ok());
}

/// What every frame of a service says about itself must be what its pixels show.
TEST(SyntheticRenderer, EveryFrameShowsTheSeqTickAndCameraThatItNames) {
  const auto renderer = service::makeSyntheticRenderer({});
  const auto log = store::makeMemoryEditLog();
  service::ServerConfig config;
  config.address = "127.0.0.1:0";
  const auto server = service::Server::start(std::move(config), *renderer, *log);
  ASSERT_TRUE(server.ok()) << server.error().message;
  ASSERT_TRUE((*server)->createCity("city", {1, 1000}).ok());
  const auto channel = grpc::CreateChannel((*server)->address(), grpc::InsecureChannelCredentials());
  const auto worlds = v1::WorldService::NewStub(channel);
  const auto viewers = v1::ViewerService::NewStub(channel);
  v1::GetWorldRequest get;
  get.set_world("city");
  v1::World world;
  for (int i = 0; i < 3000 && world.state() != v1::WORLD_STATE_READY; ++i) {
    grpc::ClientContext context;
    ASSERT_TRUE(worlds->GetWorld(&context, get, &world).ok());
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  Viewer viewer(*viewers, "city", 160, 90);
  viewer.welcome();
  uint64_t seq = 0, last_tick = 0;
  for (uint64_t id = 1; id <= 10; ++id) {
    viewer.look(id, float(id));
    v1::ApplyEditsRequest edit;
    edit.set_world("city");
    edit.set_request_id(std::to_string(id));
    edit.add_edits()->mutable_set_sun()->mutable_daylight()->set_elevation(0.1f * float(id));
    v1::ApplyEditsResponse answer;
    grpc::ClientContext context;
    ASSERT_TRUE(worlds->ApplyEdits(&context, edit, &answer).ok());
    seq = answer.seq();
    const auto frame =
        viewer.frameWhere([&](const v1::Frame& f) { return f.camera_id() == id && f.applied_seq() >= seq; });
    const auto painted = readJpeg(frame.data());
    ASSERT_TRUE(painted);
    EXPECT_EQ(painted->seq, frame.applied_seq());
    EXPECT_EQ(painted->tick, frame.tick());
    EXPECT_EQ(painted->camera, service::cameraCode({float(id), 2.0f, 3.0f}));  // where Viewer::look() stands
    EXPECT_GT(frame.tick(), last_tick);
    last_tick = frame.tick();
  }
}

}  // namespace
}  // namespace helio::test
