// helio-load as its users start it: against a synthetic server of its own.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "access/key_folder.h"
#include "access/private_file.h"
#include "lib/credentials.h"
#include "load/spawned_server.h"

namespace helio::load {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

class Program : public testing::Test {
 protected:
  Program() {
    std::string name = testing::TempDir() + "helio_load_test_XXXXXX";
    folder_ = mkdtemp(name.data());
  }
  ~Program() override { fs::remove_all(folder_); }

  /// Exit status; what it says goes to out().
  int start(const std::string& arguments) const {
    const std::string command = std::string(HELIO_LOAD) + " " + arguments + " >" + path("out") + " 2>&1";
    const int status = std::system(command.c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  std::string read(const std::string& name) const {
    std::ostringstream text;
    text << std::ifstream(path(name)).rdbuf();
    return text.str();
  }
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(path(name)) << text;
    return path(name);
  }

  fs::path folder_;
};

constexpr const char* kTiny = R"(name: tiny
duration: 2
warm_up: 0
worlds: [{ name: load-tiny }]
groups:
  - { name: g, think: 0.05, steps: [attach, jump, build: 3] }
objectives:
  - { of: lost_edits, at_most: 0 }
  - { of: frame_interval_ms, statistic: p50, at_most: LIMIT }
)";

std::string tiny(const std::string& limit) {
  std::string text = kTiny;
  text.replace(text.find("LIMIT"), 5, limit);
  return text;
}

/// A scenario of this folder without its timed objectives: what must hold on any machine stays.
std::string untimed(const std::string& name) {
  std::ostringstream whole;
  whole << std::ifstream(SCENARIOS "/" + name).rdbuf();
  std::string text = whole.str();
  const size_t timed = text.find("  # Timed");
  EXPECT_NE(timed, std::string::npos) << name;
  text.resize(std::min(timed, text.size()));
  return text;
}

/// Every step there is, connections that break, and every picture checked.
TEST_F(Program, SmokeMeetsItsObjectives) {
  const int status = start(write("smoke.yaml", untimed("smoke.yaml")) + " --spawn synthetic --json " + path("json") +
                           " --junit " + path("junit") + " --html " + path("html"));
  ASSERT_EQ(status, 0) << read("out");
  const Json report = Json::parse(read("json"));
  EXPECT_EQ(report["schema"], "heliograph.load/1");
  EXPECT_EQ(report["objectives"].size(), 7u);
  for (const auto& objective : report["objectives"]) EXPECT_EQ(objective["met"], true) << objective;
  const auto& groups = report["runs"][0]["groups"];
  for (const char* series : {"attach_ms", "first_frame_ms", "reattach_ms", "frame_interval_ms", "motion_to_photon_ms",
                             "jump_ms", "jump_complete_ms", "edit_ms", "edit_to_picture_ms", "tick_ms", "encode_ms"})
    EXPECT_GT(groups["tourists"]["series"][series]["count"], 0) << series;
  EXPECT_GT(groups["unlucky"]["series"]["reattach_ms"]["count"], 0);
  EXPECT_FALSE(groups["builders"]["series"].contains("attach_ms")) << "builders do not look";
  EXPECT_NE(read("junit").find("failures=\"0\""), std::string::npos);
  EXPECT_NE(read("html").find("heliograph.load/1"), std::string::npos);
}

TEST_F(Program, CrowdInShortMeetsItsObjectives) {
  std::string text = untimed("crowd.yaml");
  const auto replace = [&](const std::string& from, const std::string& to) {
    const size_t at = text.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    text.replace(at, from.size(), to);
  };
  replace("duration: 60", "duration: 8");
  replace("clients: 48", "clients: 12");
  replace("clients: 16", "clients: 4");
  ASSERT_EQ(start(write("crowd.yaml", text) + " --spawn synthetic --json " + path("json")), 0) << read("out");
  const Json report = Json::parse(read("json"));
  EXPECT_GE(report["objectives"].size(), 4u);
}

/// With keys: what was kept for the server goes along through the relay, and the certificate is the server's.
TEST_F(Program, ARelayTakesCredentialsAlong) {
  const access::KeyFolder keys(folder_ / "keys");
  ASSERT_TRUE(keys.create({"localhost"}).ok());
  const auto token = keys.tokens().create({"load", access::Scope::admin, {}, 0});
  ASSERT_TRUE(token.ok());
  const auto server = SpawnedServer::start(HELIOGRAPHD, {"--renderer", "synthetic", "--keys", path("keys")});
  ASSERT_TRUE(server.ok()) << server.error().message;
  // By its name, which no relay has.
  const std::string address = "localhost" + (*server)->address().substr((*server)->address().rfind(':'));
  setenv("HELIOGRAPH_CREDENTIALS", path("credentials.json").c_str(), 1);
  ASSERT_TRUE(
      client::CredentialStore().keep(address, {*access::readFile(keys.authorityCertificate()), token->text}).ok());
  std::string text = tiny("100000");
  const std::string group = "name: g,";
  text.replace(text.find(group), group.size(), "name: g, network: { delay_ms: 1 },");
  const std::string scenario = write("tiny.yaml", text);
  EXPECT_EQ(start(scenario + " --server " + address + " --json " + path("json")), 0) << read("out");
  const Json report = Json::parse(read("json"));
  EXPECT_GT(report["runs"][0]["groups"]["g"]["frames"], 0);
  EXPECT_EQ(report["runs"][0]["groups"]["g"]["failed_steps"], 0);
  // And without them nobody gets in.
  setenv("HELIOGRAPH_CREDENTIALS", path("none.json").c_str(), 1);
  EXPECT_EQ(start(scenario + " --server " + address), 2) << read("out");
  unsetenv("HELIOGRAPH_CREDENTIALS");
}

TEST_F(Program, AMissedObjectiveIsExitStatus1) {
  ASSERT_EQ(start(write("tiny.yaml", tiny("0.001")) + " --spawn synthetic --junit " + path("junit")), 1) << read("out");
  EXPECT_NE(read("out").find("MISSED"), std::string::npos);
  EXPECT_NE(read("junit").find("<failure"), std::string::npos);
}

TEST_F(Program, ABaselineIsComparedWith) {
  const std::string scenario = write("tiny.yaml", tiny("100000"));
  ASSERT_EQ(start(scenario + " --spawn synthetic --json " + path("before")), 0) << read("out");
  ASSERT_EQ(start(scenario + " --spawn synthetic --json " + path("now") + " --baseline " + path("before")), 0)
      << read("out");
  EXPECT_GT(Json::parse(read("now"))["baseline"].size(), 4u);
  // As if everything had been a thousand times as fast once.
  Json before = Json::parse(read("before"));
  for (auto& [name, series] : before["runs"][0]["groups"]["g"]["series"].items())
    for (const char* statistic : {"p50", "p99"}) series[statistic] = series[statistic].get<double>() / 1000;
  write("before", before.dump());
  EXPECT_EQ(start(scenario + " --spawn synthetic --max-regression 50 --baseline " + path("before")), 1) << read("out");
}

TEST_F(Program, WhatCannotBeMeasuredIsExitStatus2) {
  EXPECT_EQ(start(write("wrong.yaml", "name: x\n") + " --spawn synthetic"), 2);
  EXPECT_NE(read("out").find("no \"worlds\""), std::string::npos) << read("out");
  const std::string scenario = write("tiny.yaml", tiny("1"));
  EXPECT_EQ(start(scenario), 2);
  EXPECT_EQ(start(scenario + " --server 192.0.2.1:7700"), 2);
  EXPECT_NE(read("out").find("not on loopback"), std::string::npos);
  EXPECT_EQ(start(scenario + " --server 127.0.0.1:1"), 2);
  EXPECT_EQ(start(scenario + " --spawn synthetic --baseline " + path("missing")), 2);
}

}  // namespace
}  // namespace helio::load
