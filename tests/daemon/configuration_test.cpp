// Flags, environment and file: which counts, and what is refused.
#include "daemon/configuration.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace helio::daemon {
namespace {

using testing::HasSubstr;

class ConfigurationTest : public testing::Test {
 protected:
  ConfigurationTest() {
    std::string name = testing::TempDir() + "heliograph_configuration_XXXXXX";
    folder_ = mkdtemp(name.data());
    unsetenv("HELIOGRAPH_DEVICE");  // the test run's own
  }
  ~ConfigurationTest() override {
    std::filesystem::remove_all(folder_);
    for (const auto& name : set_) unsetenv(name.c_str());
  }

  void environment(const std::string& name, const std::string& value) {
    setenv(name.c_str(), value.c_str(), 1);
    set_.push_back(name);
  }
  std::string file(const std::string& text) {
    const auto path = (folder_ / "heliographd.yaml").string();
    std::ofstream(path) << text;
    return path;
  }
  static Result<Invocation> parse(std::vector<std::string> arguments) {
    std::vector<const char*> argv = {"heliographd"};
    for (const auto& argument : arguments) argv.push_back(argument.c_str());
    auto parsed = parseCommandLine(static_cast<int>(argv.size()), argv.data());
    if (!parsed) return parsed.error();
    EXPECT_TRUE(parsed->has_value()) << "help was printed";
    return std::move(**parsed);
  }
  std::string refusal(const std::string& yaml) {
    const auto parsed = parse({"--config", file(yaml)});
    return parsed ? "taken" : parsed.error().message;
  }

  std::filesystem::path folder_;
  std::vector<std::string> set_;
};

TEST_F(ConfigurationTest, AFlagCountsBeforeTheEnvironmentAndThatBeforeTheFile) {
  const auto yaml = file("max-fps: 20\nmax-worlds: 3\nmax-viewers: 5\nlog-level: warn\nvalidation: true\n");
  environment("HELIOGRAPH_MAX_WORLDS", "4");
  environment("HELIOGRAPH_MAX_VIEWERS", "6");
  const auto parsed = parse({"--config", yaml, "--max-viewers", "7"});
  ASSERT_TRUE(parsed.ok()) << parsed.error().message;
  const auto& limits = parsed->configuration.server.limits;
  EXPECT_EQ(limits.max_fps, 20u);
  EXPECT_EQ(limits.max_worlds, 4u);
  EXPECT_EQ(limits.max_viewers, 7u);
  EXPECT_EQ(parsed->configuration.log_level, "warn");
  EXPECT_TRUE(parsed->configuration.device.validation);
}

TEST_F(ConfigurationTest, TheEnvironmentMayNameTheFile) {
  environment("HELIOGRAPH_CONFIG", file("listen: 127.0.0.1:1234\n"));
  EXPECT_EQ(parse({})->configuration.server.address, "127.0.0.1:1234");
  environment("HELIOGRAPH_CONFIG", "/nowhere/heliographd.yaml");
  EXPECT_FALSE(parse({}).ok());
}

TEST_F(ConfigurationTest, WhatIsUnknownOrWrongIsRefusedByName) {
  EXPECT_THAT(refusal("listen: 127.0.0.1:1\nmax-world: 3\n"), HasSubstr("\"max-world\" (line 2)"));
  EXPECT_THAT(refusal("config: other.yaml\n"), HasSubstr("\"config\""));
  EXPECT_THAT(refusal("help: true\n"), HasSubstr("\"help\""));
  EXPECT_THAT(refusal("init: true\n"), HasSubstr("\"init\""));
  EXPECT_THAT(refusal("max-fps: 20\nmax-fps: 30\n"), HasSubstr("twice"));
  EXPECT_THAT(refusal("max-fps: 100000\n"), HasSubstr("max-fps"));
  EXPECT_THAT(refusal("max-fps: many\n"), HasSubstr("max-fps"));
  EXPECT_THAT(refusal("max-fps: {a: 1}\n"), HasSubstr("max-fps"));
  EXPECT_THAT(refusal("- listen\n"), HasSubstr("no map"));
  EXPECT_THAT(refusal("listen: [\n"), HasSubstr("no YAML"));
  EXPECT_THAT(refusal("renderer: magic\n"), HasSubstr("renderer"));
  EXPECT_EQ(refusal(""), "taken");
  EXPECT_FALSE(parse({"--no-such-flag"}).ok());
  EXPECT_FALSE(parse({"--config", "/nowhere/heliographd.yaml"}).ok());
  EXPECT_FALSE(parse({"serve"}).ok());
}

TEST_F(ConfigurationTest, WhatIsInEffectCanBeReadBackAndEveryKeyIsAVariable) {
  const auto first =
      parse({"--check-config", "--max-fps", "25", "--listen", "127.0.0.1:4321", "--log-dir", "/some where"});
  ASSERT_TRUE(first.ok()) << first.error().message;
  EXPECT_EQ(first->command, Command::check_configuration);
  const std::string text = first->configuration.in_effect;
  EXPECT_THAT(text, HasSubstr("max-fps: 25"));
  const auto second = parse({"--check-config", "--config", file(text)});
  ASSERT_TRUE(second.ok()) << second.error().message;
  EXPECT_EQ(second->configuration.in_effect, text);
  EXPECT_EQ(second->configuration.log_folder, "/some where");

  // Every number of it, by its variable.
  std::istringstream lines(text);
  int checked = 0;
  for (std::string line; std::getline(lines, line);) {
    const auto colon = line.find(": ");
    const auto key = line.substr(0, colon), value = line.substr(colon + 2);
    if (key.rfind("max-", 0) != 0) continue;
    std::string variable = "HELIOGRAPH_" + key;
    for (char& c : variable) c = c == '-' ? '_' : static_cast<char>(std::toupper(c));
    setenv(variable.c_str(), "no number", 1);
    EXPECT_FALSE(parse({}).ok()) << variable << " means nothing";
    unsetenv(variable.c_str());
    ++checked;
  }
  EXPECT_GE(checked, 10);
}

TEST_F(ConfigurationTest, CommandsTakeTheServersFlags) {
  const auto init = parse({"init", "--keys", "/keys", "--host", "a.example", "--host", "b.example", "--renew"});
  ASSERT_TRUE(init.ok()) << init.error().message;
  EXPECT_EQ(init->command, Command::init);
  EXPECT_EQ(init->configuration.server.keys, "/keys");
  EXPECT_THAT(init->init.hosts, testing::ElementsAre("a.example", "b.example"));
  EXPECT_TRUE(init->init.renew);
  const auto doctor = parse({"doctor", "--json", "--listen", "127.0.0.1:1"});
  ASSERT_TRUE(doctor.ok()) << doctor.error().message;
  EXPECT_EQ(doctor->command, Command::doctor);
  EXPECT_TRUE(doctor->json);
}

TEST_F(ConfigurationTest, CullingIsChosenWithItsThresholds) {
  EXPECT_EQ(parse({})->configuration.device.culling, render::Culling::full);
  const auto chosen = parse({"--culling", "lipac", "--culling-own-activate", "500", "--culling-mitigation", "false"});
  ASSERT_TRUE(chosen.ok());
  const render::RendererOptions& device = chosen->configuration.device;
  EXPECT_EQ(device.culling, render::Culling::lipac);
  EXPECT_EQ(device.culling_settings.lipac.own_activate, 500.0f);
  EXPECT_FALSE(device.culling_settings.lipac.mitigation);
  EXPECT_TRUE(device.culling_settings.cast_by_map);
  EXPECT_FALSE(parse({"--culling", "magic"}).ok());
  EXPECT_FALSE(parse({"--culling", "lipac", "--culling-box-activate", "1"}).ok());
}

}  // namespace
}  // namespace helio::daemon
