// Health and metrics, asked for as an orchestrator does.
#include "daemon/ops_port.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <httplib.h>

#include <memory>

namespace helio::daemon {
namespace {

class OpsPortTest : public testing::Test {
 protected:
  OpsPortTest() {
    auto opened = OpsPort::open("127.0.0.1:0");
    EXPECT_TRUE(opened.ok()) << opened.error().message;
    port_ = std::move(*opened);
    client_ = std::make_unique<httplib::Client>("http://" + port_->address());
  }

  int status(const std::string& path) {
    const auto answer = client_->Get(path);
    EXPECT_TRUE(answer) << path;
    body_ = answer ? answer->body : "";
    return answer ? answer->status : 0;
  }

  std::unique_ptr<OpsPort> port_;
  std::unique_ptr<httplib::Client> client_;
  std::string body_;
};

TEST_F(OpsPortTest, AliveFromTheStartAndReadyWhenItIs) {
  EXPECT_EQ(status("/livez"), 200);
  EXPECT_EQ(status("/readyz"), 503);
  EXPECT_EQ(body_, "starting\n");
  EXPECT_EQ(status("/metrics"), 200);
  EXPECT_EQ(body_, "");

  std::string why = "draining";
  port_->show({[&] { return why; }, [] { return std::string("heliograph_ready 1\n"); }});
  EXPECT_EQ(status("/readyz"), 503);
  EXPECT_EQ(body_, "draining\n");
  EXPECT_EQ(status("/livez"), 200) << "a server that is not ready would be restarted";
  why.clear();
  EXPECT_EQ(status("/readyz"), 200);
  EXPECT_EQ(status("/metrics"), 200);
  EXPECT_EQ(body_, "heliograph_ready 1\n");
  port_->show({});
  EXPECT_EQ(status("/readyz"), 503);
  EXPECT_EQ(status("/livez"), 200);
}

TEST_F(OpsPortTest, NothingElseIsThere) {
  for (const char* path : {"/", "/worlds", "/livez/", "/debug/pprof", "/../etc/passwd"})
    EXPECT_EQ(status(path), 404) << path;
  const auto posted = client_->Post("/livez", "x", "text/plain");
  ASSERT_TRUE(posted);
  EXPECT_NE(posted->status, 200);
}

TEST_F(OpsPortTest, AddressesThatCannotBe) {
  const auto again = OpsPort::open(port_->address());
  ASSERT_FALSE(again.ok());
  EXPECT_EQ(again.error().kind, ErrorKind::unavailable);
  for (const char* bad : {"", "9700", ":9700", "127.0.0.1:", "127.0.0.1:65536", "127.0.0.1:http"})
    EXPECT_EQ(OpsPort::open(bad).error().kind, ErrorKind::invalid) << bad;
}

}  // namespace
}  // namespace helio::daemon
