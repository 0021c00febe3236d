// A jump has ended when its picture is there, and is complete when nothing waits any more for a place in it.
#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "lib/connection.h"
#include "load/viewer.h"
#include "service/server.h"
#include "service/synthetic_renderer.h"
#include "store/edit_log.h"

namespace helio::load {
namespace {

using namespace std::chrono_literals;

/// The synthetic renderer, whose frames say that as many BLASes wait as it is told.
class Waiting final : public render::Renderer {
 public:
  std::atomic<uint32_t> own{0}, shared{0};

  render::DeviceInfo device() const override { return renderer_->device(); }
  Result<render::WorldHandle> addWorld(scene::ScenePtr scene) override { return renderer_->addWorld(std::move(scene)); }
  void removeWorld(render::WorldHandle world) override { renderer_->removeWorld(world); }
  Result<render::ViewHandle> addView(render::WorldHandle world) override { return renderer_->addView(world); }
  void removeView(render::ViewHandle view) override { renderer_->removeView(view); }
  Result<std::vector<render::Frame>> tick(render::WorldHandle world, const world::ChangeSet& changes,
                                          std::span<const render::ViewRequest> views) override {
    auto frames = renderer_->tick(world, changes, views);
    if (frames)
      for (render::Frame& frame : *frames) {
        frame.stats.acceleration.own_blases_waiting = own;
        frame.stats.acceleration.shared_blases_waiting = shared;
      }
    return frames;
  }

 private:
  const std::unique_ptr<render::Renderer> renderer_ = service::makeSyntheticRenderer({});
};

TEST(Jump, IsCompleteWhenNothingWaits) {
  Waiting renderer;
  const auto log = store::makeMemoryEditLog();
  service::ServerConfig config;
  config.address = "127.0.0.1:0";
  auto server = service::Server::start(std::move(config), renderer, *log);
  ASSERT_TRUE(server) << server.error().message;
  ASSERT_TRUE((*server)->createCity("city", {1, 1000}));

  const auto start = Clock::now();
  Record record(start);
  Viewer::Options options;
  options.world = "city";
  options.settings.set_width(64);
  options.settings.set_height(32);
  options.measured_from = start;
  client::Connection connection((*server)->address());
  Viewer viewer(record, options);
  const auto frames = [&](uint64_t more) {
    const auto patience = Clock::now() + 60s;
    for (const uint64_t until = record.counts().frames + more; record.counts().frames < until;) {
      ASSERT_LT(Clock::now(), patience) << "no frames come";
      std::this_thread::sleep_for(1ms);
    }
  };
  const auto attached = viewer.attach(connection, {{0, 10, 0}}, start, kFirstFrame);
  ASSERT_TRUE(attached) << attached.error().message;
  renderer.own = 3;
  frames(3);  // what was under way when it was told is shown
  const auto jumped = Clock::now();
  viewer.jump({{100, 10, 0}}, jumped);
  frames(5);
  renderer.shared = 1;
  frames(3);
  renderer.own = 0;
  const auto still_waits = Clock::now();
  frames(5);
  renderer.shared = 0;
  frames(5);
  viewer.close();

  ASSERT_EQ(record.series(kJump).size(), 1u);
  ASSERT_EQ(record.series(kJumpComplete).size(), 1u) << "once a jump";
  const float least = static_cast<float>(secondsBetween(jumped, still_waits) * 1000);
  EXPECT_LT(record.series(kJump)[0].value, least);
  EXPECT_GT(record.series(kJumpComplete)[0].value, least) << "own BLASes alone are not all that may wait";
}

}  // namespace
}  // namespace helio::load
