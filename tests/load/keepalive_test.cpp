// A client whose machine loses its power while it owes no acknowledgement: nothing but the keepalive finds out.
#include <gtest/gtest.h>

#include <thread>

#include "lib/connection.h"
#include "lib/viewer_session.h"
#include "load/relay.h"
#include "service/server.h"
#include "service/synthetic_renderer.h"
#include "store/edit_log.h"

namespace helio::load {
namespace {

using namespace std::chrono_literals;

TEST(Keepalive, EndsAViewerWhoseMachineIsGone) {
  const auto renderer = service::makeSyntheticRenderer({});
  const auto log = store::makeMemoryEditLog();
  service::ServerConfig config;
  config.address = "127.0.0.1:0";
  config.limits.max_silence_seconds = 3600;  // not who finds out here
  config.limits.resume_seconds = 0;
  auto server = service::Server::start(std::move(config), *renderer, *log);
  ASSERT_TRUE(server) << server.error().message;
  ASSERT_TRUE((*server)->createCity("city", {1, 1000}));
  auto relay = Relay::start((*server)->address(), {}, 1);
  ASSERT_TRUE(relay) << relay.error().message;

  client::Connection far((*relay)->address()), near((*server)->address());
  client::ViewerSession::Options wishes;
  wishes.world = "city";
  wishes.settings.set_width(64);
  wishes.settings.set_height(32);
  wishes.settings.set_paused(true);
  const auto session = client::ViewerSession::attach(far, wishes);
  ASSERT_TRUE(session) << session.error().message;
  const auto viewers = [&] {
    const auto world = near.world("city");
    EXPECT_TRUE(world) << world.error().message;
    return world ? world->viewers() : 0;
  };
  EXPECT_EQ(viewers(), 1u);
  (*relay)->freeze();
  const auto patience = client::Clock::now() + 60s;  // it takes 10 s to 15 s
  while (viewers() != 0 && client::Clock::now() < patience) std::this_thread::sleep_for(100ms);
  EXPECT_EQ(viewers(), 0u) << "a peer that answers no keepalive is still taken for a viewer";
}

}  // namespace
}  // namespace helio::load
