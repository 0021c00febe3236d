// The parts of a load test, each against what it must do: statistics, plots, objectives, the relay.
#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <glm/geometric.hpp>
#include <set>
#include <thread>

#include "base/median.h"
#include "load/plot.h"
#include "load/relay.h"
#include "load/report.h"

namespace helio::load {
namespace {

TEST(Metrics, PercentilesAreNearestRank) {
  std::vector<double> values;
  for (int i = 1; i <= 100; ++i) values.push_back(i);
  EXPECT_EQ(statistic(values, "p50"), 50);
  EXPECT_EQ(statistic(values, "p99"), 99);
  EXPECT_EQ(statistic(values, "p99.9"), 100);
  EXPECT_EQ(statistic(values, "min"), 1);
  EXPECT_EQ(statistic(values, "max"), 100);
  EXPECT_EQ(statistic(values, "mean"), 50.5);
  EXPECT_EQ(statistic({}, "p50"), std::nullopt);
  EXPECT_EQ(median({3, 1, 2}), 2);
  EXPECT_EQ(median({4, 1, 2, 3}), 2.5);
}

TEST(Metrics, EveryNameIsKnownAndNoOther) {
  for (const char* name : kSeriesNames) EXPECT_TRUE(isMetric(name) && hasStatistic(name)) << name;
  for (const char* name : kRunCountNames)
    EXPECT_TRUE(isMetric(name) && !hasStatistic(name) && !knowsGroups(name)) << name;
  for (const char* name : kGroupCountNames) EXPECT_TRUE(isMetric(name) && knowsGroups(name)) << name;
  EXPECT_FALSE(isMetric("speed"));
}

// ---- Plots

v1::Bounds bounds() {
  v1::Bounds out;
  out.mutable_min()->set_x(-500);
  out.mutable_max()->set_x(500);
  out.mutable_max()->set_y(40.3f);
  return out;
}

/// The instances that a build makes.
std::vector<v1::Instance> instancesOf(const v1::ApplyEditsRequest& request) {
  std::vector<v1::Instance> out;
  const auto& placements = request.edits(0).build().placements();
  for (int i = 0; i < placements.size(); i += 8) {
    auto& instance = out.emplace_back();
    instance.set_id(uint64_t(i));
    for (const float value : {1.f, 0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f}) instance.add_transform(value);
    for (int k = 0; k < 3; ++k) instance.add_transform(placements[i + k]);
  }
  return out;
}

const Result<v1::ApplyEditsResponse> kDone = v1::ApplyEditsResponse();
const Result<v1::ApplyEditsResponse> kNoAnswer = Error{ErrorKind::unavailable, "gone", {}, {}, {}};

TEST(Plot, PlotsDoNotTouch) {
  std::set<std::pair<int, int>> cells;
  for (uint32_t i = 0; i < 200; ++i) {
    const auto cell = Plot::spiral(i);
    EXPECT_TRUE(cells.insert({cell.x, cell.y}).second) << i;
    EXPECT_LE(std::max(std::abs(cell.x), std::abs(cell.y)), 8) << i;
  }
  EXPECT_GT(Plot::kSpacing, Plot::kRadius + Plot::kRadius);
}

TEST(Plot, EveryEditIsAccountedFor) {
  Plot plot("a", bounds(), 3);
  const auto first = plot.build("house", 5);
  plot.built(first, kDone);
  auto there = instancesOf(first);
  for (const auto& instance : there) {
    const glm::vec2 at(instance.transform(9), instance.transform(11));
    EXPECT_LE(glm::length(at - plot.middle()), Plot::kBuildRadius);
  }
  EXPECT_EQ(plot.verify(there).lost + plot.verify(there).doubled, 0u);

  auto fewer = there;
  fewer.pop_back();
  EXPECT_EQ(plot.verify(fewer).lost, 1u);
  auto more = there;
  more.push_back(there.front());
  EXPECT_EQ(plot.verify(more).doubled, 1u);

  const auto unanswered = plot.build("house", 2);  // may be there or not, but not twice
  plot.built(unanswered, kNoAnswer);
  EXPECT_EQ(plot.verify(there).lost, 0u);
  for (const auto& instance : instancesOf(unanswered)) there.push_back(instance);
  EXPECT_EQ(plot.verify(there).doubled, 0u);
  there.push_back(there.back());
  EXPECT_EQ(plot.verify(there).doubled, 1u);

  plot.destroyed(kDone);
  EXPECT_EQ(plot.verify({}).lost, 0u);
  EXPECT_EQ(plot.verify(fewer).lost, 4u) << "destroyed, acknowledged, and there all the same";
}

TEST(Plot, OthersInstancesAreNobodysLoss) {
  Plot plot("a", bounds(), 0);
  plot.built(plot.build("house", 1), kNoAnswer);
  v1::Instance tree;
  for (int i = 0; i < 12; ++i) tree.add_transform(0.3f);
  EXPECT_EQ(plot.verify({tree}).lost + plot.verify({tree}).doubled, 0u);
}

// ---- Objectives

Scenario scenarioWith(const std::string& objective) {
  auto parsed = parseScenario(
      "name: t\nvariants: [usual, hard]\nworlds: [{ name: a }]\ngroups:\n  - { name: g, steps: "
      "[attach] }\nobjectives:\n  - " +
      objective + "\n");
  EXPECT_TRUE(parsed) << parsed.error().message;
  return parsed ? *parsed : Scenario{};
}

/// A run of one client whose edits took so long.
RunResult runOf(const std::string& variant, const std::vector<double>& edit_ms) {
  RunResult run{variant, 1, 10, 0, "1", "none", {}, {}, 0, 0};
  const auto start = Clock::now();
  auto record = std::make_unique<Record>(start);
  for (const double ms : edit_ms) record->add(kEdit, start + std::chrono::seconds(1), ms);
  run.clients.push_back({0, std::move(record)});
  return run;
}

std::vector<RunResult> runs(std::initializer_list<std::pair<const char*, std::vector<double>>> list) {
  std::vector<RunResult> out;
  for (const auto& [variant, values] : list) out.push_back(runOf(variant, values));
  return out;
}

TEST(Objectives, TheWorstRunCounts) {
  const auto scenario = scenarioWith("{ of: edit_ms, statistic: max, at_most: 5 }");
  EXPECT_TRUE(judge(scenario, runs({{"usual", {1, 5}}, {"hard", {2}}})).front().met);
  const auto missed = judge(scenario, runs({{"usual", {1, 5}}, {"hard", {6}}})).front();
  EXPECT_FALSE(missed.met);
  EXPECT_EQ(missed.value, 6);
}

TEST(Objectives, NothingMeasuredMeetsNothing) {
  const auto judged = judge(scenarioWith("{ of: jump_ms, statistic: p99, at_most: 5 }"), runs({{"usual", {1}}}));
  EXPECT_FALSE(judged.front().met);
  EXPECT_FALSE(judged.front().value);
}

TEST(Objectives, VariantsAreComparedBeyondTheSpreadOfRuns) {
  const auto scenario = scenarioWith("{ of: edit_ms, statistic: p50, variant: hard, against: usual, at_most: 10 }");
  // Medians 100 and 114: +14 %, the usual runs are 5 % apart.
  const auto judged =
      judge(scenario, runs({{"usual", {98}}, {"usual", {100}}, {"usual", {103}}, {"hard", {114}}})).front();
  EXPECT_NEAR(*judged.value, 14, 1e-6);
  EXPECT_NEAR(judged.limit, 15, 1e-6);
  EXPECT_TRUE(judged.met);
  EXPECT_FALSE(judge(scenario, runs({{"usual", {100}}, {"hard", {111}}})).front().met);
  // One run that the machine spoilt excuses nothing: quartiles 99 and 102.
  const auto spoilt = judge(
      scenario,
      runs({{"usual", {98}}, {"usual", {99}}, {"usual", {100}}, {"usual", {102}}, {"usual", {190}}, {"hard", {114}}}));
  EXPECT_NEAR(spoilt.front().limit, 13, 1e-6);
  EXPECT_FALSE(spoilt.front().met);
  const auto difference =
      scenarioWith("{ of: edit_ms, statistic: p50, variant: hard, against: usual, by: difference, at_most: 10 }");
  EXPECT_EQ(judge(difference, runs({{"usual", {100}}, {"hard", {108}}})).front().value, 8);
}

TEST(Report, SaysTheSameInJsonJunitAndPage) {
  const auto scenario = scenarioWith("{ of: edit_ms, statistic: max, at_most: 5, name: \"a < b </script>\" }");
  const auto measured = runs({{"usual", {1, 6}}});
  const Json report = reportOf(scenario, measured, judge(scenario, measured), {"helio-load", "2026-01-01T00:00:00Z"});
  EXPECT_EQ(report["objectives"][0]["value"], 6.0);
  EXPECT_EQ(report["objectives"][0]["met"], false);
  EXPECT_EQ(report["runs"][0]["groups"]["g"]["series"]["edit_ms"]["count"], 2);
  const std::string junit = junitOf(report);
  EXPECT_NE(junit.find("failures=\"1\""), std::string::npos);
  EXPECT_NE(junit.find("a &lt; b &lt;/script&gt;"), std::string::npos);
  const std::string page = pageOf(report);
  EXPECT_EQ(page.find("/*REPORT*/null"), std::string::npos);
  EXPECT_EQ(page.find("b </script>"), std::string::npos) << "a name must not end the script";

  const auto later = runs({{"usual", {2, 3}}});
  const auto changes =
      compare(report, reportOf(scenario, later, judge(scenario, later), {"helio-load", "2026-01-02T00:00:00Z"}));
  ASSERT_TRUE(changes);
  EXPECT_EQ(changes->back().statistic, "p99");
  EXPECT_EQ(changes->back().percent(), -50);
  EXPECT_FALSE(compare(Json::object(), report));
  EXPECT_FALSE(compare(Json::array(), report));
}

// ---- The relay

int listener(uint16_t& port) {
  const int fd = socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in at{};
  at.sin_family = AF_INET;
  at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof at;
  EXPECT_EQ(bind(fd, reinterpret_cast<sockaddr*>(&at), size), 0);
  EXPECT_EQ(listen(fd, 4), 0);
  getsockname(fd, reinterpret_cast<sockaddr*>(&at), &size);
  port = ntohs(at.sin_port);
  return fd;
}

/// A listener, a relay to it, and a connection through both.
struct Line {
  explicit Line(const Network& network) {
    uint16_t port = 0;
    listening = listener(port);
    auto started = Relay::start("127.0.0.1:" + std::to_string(port), network, 1);
    EXPECT_TRUE(started) << started.error().message;
    relay = std::move(*started);
    client = socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in at{};
    at.sin_family = AF_INET;
    at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    at.sin_port = htons(static_cast<uint16_t>(std::stoi(relay->address().substr(relay->address().rfind(':') + 1))));
    EXPECT_EQ(connect(client, reinterpret_cast<sockaddr*>(&at), sizeof at), 0);
    server = accept(listening, nullptr, nullptr);
  }
  ~Line() {
    for (const int fd : {listening, client, server}) close(fd);
  }
  int listening = -1, client = -1, server = -1;
  std::unique_ptr<Relay> relay;
};

std::string receive(int fd, size_t size) {
  std::string out(size, '\0');
  size_t got = 0;
  while (got < size) {
    const ssize_t count = recv(fd, out.data() + got, size - got, 0);
    if (count <= 0) break;
    got += static_cast<size_t>(count);
  }
  out.resize(got);
  return out;
}

TEST(Relay, CarriesEveryByteInOrderBothWaysAndTheEnd) {
  Line line({1, 0, 0.05});
  std::string bytes(3 << 20, '\0');
  for (size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<char>(i * 2654435761u >> 13);
  for (const auto& [from, to] : {std::pair{line.client, line.server}, {line.server, line.client}}) {
    std::thread sender([&, from = from] {
      for (size_t sent = 0; sent < bytes.size();)
        sent += size_t(send(from, bytes.data() + sent, bytes.size() - sent, 0));
    });
    EXPECT_TRUE(receive(to, bytes.size()) == bytes);
    sender.join();
  }
  shutdown(line.client, SHUT_WR);
  EXPECT_EQ(receive(line.server, 1), "");
  EXPECT_EQ(send(line.server, "still", 5, 0), 5);
  EXPECT_EQ(receive(line.client, 5), "still") << "the other direction is open";
}

TEST(Relay, DelaysAndHoldsToTheRate) {
  Line delayed({40, 0, 0});
  auto start = Clock::now();
  send(delayed.client, "x", 1, 0);
  EXPECT_EQ(receive(delayed.server, 1), "x");
  EXPECT_GE(secondsBetween(start, Clock::now()), 0.04);

  Line slow({0, 8000, 0});  // a megabyte a second
  start = Clock::now();
  const std::string bytes(200'000, 'y');
  std::thread sender([&] { send(slow.client, bytes.data(), bytes.size(), 0); });
  EXPECT_EQ(receive(slow.server, bytes.size()).size(), bytes.size());
  EXPECT_GE(secondsBetween(start, Clock::now()), 0.15);
  sender.join();
}

TEST(Relay, CutIsAResetAndFrozenIsSilence) {
  Line cut({});
  send(cut.client, "x", 1, 0);
  EXPECT_EQ(receive(cut.server, 1), "x");
  cut.relay->cut();
  char byte;
  EXPECT_EQ(recv(cut.server, &byte, 1, 0), -1);
  EXPECT_EQ(errno, ECONNRESET);

  Line frozen({});
  send(frozen.client, "x", 1, 0);
  EXPECT_EQ(receive(frozen.server, 1), "x");
  frozen.relay->freeze();
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  close(frozen.client);
  frozen.client = -1;
  const timeval patience{0, 200'000};
  setsockopt(frozen.server, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
  EXPECT_EQ(recv(frozen.server, &byte, 1, 0), -1);
  EXPECT_EQ(errno, EAGAIN) << "the server must not learn that its client is gone";
}

}  // namespace
}  // namespace helio::load
