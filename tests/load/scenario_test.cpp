// What a scenario may say: everything else is refused, with line and name.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "load/scenario.h"

namespace helio::load {
namespace {

using testing::HasSubstr;

constexpr const char* kHead = R"(name: test
duration: 4
worlds:
  - { name: a }
)";
constexpr const char* kTail = R"(objectives:
  - { of: lost_edits, at_most: 0 }
)";

std::string withGroup(const std::string& group) { return kHead + std::string("groups:\n") + group + kTail; }
std::string withObjective(const std::string& objective) {
  return kHead + std::string("groups:\n  - { name: g, steps: [attach, jump] }\nobjectives:\n  - ") + objective + "\n";
}

std::string errorOf(const std::string& text) {
  const auto parsed = parseScenario(text);
  return parsed ? "it was taken" : parsed.error().message;
}

TEST(Scenario, EveryStepIsRead) {
  const auto parsed = parseScenario(withGroup(R"(  - name: g
    clients: 3
    size: 320x180
    think: [0.5, 1.5]
    network: { delay_ms: 50, rate_kbps: 8000, loss: 0.01 }
    steps:
      - attach
      - fly: { through: [north, south], seconds: 2.5 }
      - jump: north
      - look-at-mirror
      - build: { count: 7, prefab: house }
      - destroy
      - light: { elevation: 10, azimuth: -20 }
      - repeat: { times: 3, steps: [idle: 0.5, build: 2] }
      - stop-reading: 1
      - vanish
      - reconnect
      - half-open
)"));
  ASSERT_TRUE(parsed) << parsed.error().message;
  const Group& group = parsed->groups.front();
  EXPECT_EQ(group.clients, 3u);
  EXPECT_EQ(group.width, 320u);
  EXPECT_EQ(group.think_high, 1.5);
  EXPECT_EQ(group.network.delay_ms, 50);
  EXPECT_EQ(group.worlds, std::vector<std::string>{"a"});
  EXPECT_TRUE(group.relayed());
  std::vector<std::string> names;
  for (const auto& step : group.steps) names.push_back(nameOf(step));
  EXPECT_EQ(names, (std::vector<std::string>{"attach", "fly", "jump", "look-at-mirror", "build", "destroy", "light",
                                             "repeat", "stop-reading", "vanish", "reconnect", "half-open"}));
  EXPECT_EQ(std::get<Fly>(group.steps[1]).through, (std::vector<std::string>{"north", "south"}));
  EXPECT_EQ(std::get<BuildStep>(group.steps[4]).prefab, "house");
  EXPECT_EQ(std::get<Light>(group.steps[6]).azimuth, -20);
  EXPECT_EQ(std::get<Repeat>(group.steps[7]).steps.size(), 2u);
}

TEST(Scenario, WhatIsUnknownIsRefusedWithLineAndName) {
  EXPECT_THAT(errorOf(withGroup("  - name: g\n    thnik: 1\n    steps: [attach]\n")),
              testing::AllOf(HasSubstr("line 7"), HasSubstr("unknown key \"thnik\""), HasSubstr("think")));
  EXPECT_THAT(errorOf(withGroup("  - name: g\n    steps:\n      - attach\n      - dance\n")),
              testing::AllOf(HasSubstr("line 9"), HasSubstr("dance"), HasSubstr("stop-reading")));
  EXPECT_THAT(errorOf(withGroup("  - name: g\n    worlds: [b]\n    steps: [attach]\n")), HasSubstr("no world \"b\""));
  EXPECT_THAT(errorOf(withObjective("{ of: speed, at_least: 3 }")), HasSubstr("no metric \"speed\""));
  EXPECT_THAT(errorOf(withObjective("{ of: jump_ms, statistic: p98, at_most: 3 }")), HasSubstr("p98"));
  EXPECT_THAT(errorOf(withObjective("{ of: jump_ms, at_most: 3 }")), HasSubstr("\"statistic\""));
  EXPECT_THAT(errorOf(withObjective("{ of: lost_edits, group: g, at_most: 3 }")), HasSubstr("all clients"));
  EXPECT_THAT(errorOf(withObjective("{ of: frames, group: h, at_most: 3 }")), HasSubstr("no group \"h\""));
  EXPECT_THAT(errorOf(withObjective("{ of: frames }")), HasSubstr("at_most"));
  EXPECT_THAT(errorOf(withObjective("{ of: frames, at_most: 1, at_least: 1 }")), HasSubstr("at_least"));
}

TEST(Scenario, WhatCannotBeKeptIsRefused) {
  EXPECT_THAT(errorOf(withGroup("  - { name: g, clients: 257, steps: [attach] }\n")), HasSubstr("1 to 256"));
  EXPECT_THAT(errorOf(withGroup("  - { name: g, steps: [jump] }\n")), HasSubstr("needs \"attach\""));
  EXPECT_THAT(errorOf(withGroup("  - { name: g, steps: [attach, vanish, jump] }\n")), HasSubstr("\"jump\" needs"));
  // The second time round nobody is attached any more.
  EXPECT_THAT(errorOf(withGroup("  - { name: g, steps: [attach, repeat: { times: 2, steps: [jump, vanish] }] }\n")),
              HasSubstr("\"jump\" needs"));
  EXPECT_THAT(errorOf(withGroup("  - { name: g, rate: 2, steps: [attach, idle: 0.6] }\n")),
              HasSubstr("longer than the time between two steps"));
  EXPECT_THAT(errorOf(withGroup("  - { name: g, rate: 2, think: 1, steps: [attach] }\n")), HasSubstr("closed loops"));
  EXPECT_THAT(errorOf(withGroup("  - { name: g, arrivals: poisson, steps: [attach] }\n")), HasSubstr("\"rate\""));
  EXPECT_THAT(errorOf(withGroup("  - { name: g, clients: 2.5, steps: [attach] }\n")), HasSubstr("whole number"));
  EXPECT_THAT(errorOf(withGroup("  - { name: g, rate: .nan, steps: [attach] }\n")), HasSubstr("must be a number"));
  EXPECT_THAT(errorOf(withGroup("  - { name: g, name: h, steps: [attach] }\n")), HasSubstr("occurs twice"));
  EXPECT_THAT(errorOf(withGroup("  - { name: g, steps: [attach] }\n  - { name: g, steps: [attach] }\n")),
              HasSubstr("occurs twice"));
  EXPECT_THAT(errorOf("name: [\n"), HasSubstr("not YAML"));
  EXPECT_THAT(errorOf("just words"), HasSubstr("must be a mapping"));
  EXPECT_THAT(errorOf(""), HasSubstr("must be a mapping"));
}

TEST(Scenario, EveryFileHereIsRead) {
  size_t read = 0;
  for (const auto& entry : std::filesystem::directory_iterator(SCENARIOS)) {
    if (entry.path().extension() != ".yaml") continue;
    const auto parsed = readScenario(entry.path());
    EXPECT_TRUE(parsed) << parsed.error().message;
    if (parsed) { EXPECT_EQ(parsed->name, entry.path().stem()); }
    ++read;
  }
  EXPECT_GE(read, 7u);
}

}  // namespace
}  // namespace helio::load
