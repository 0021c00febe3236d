#include "load/scenario.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <fstream>
#include <set>
#include <sstream>

#include "load/metrics.h"
#include "load/yaml_map.h"

namespace helio::load {
namespace {

bool contains(const std::vector<std::string>& list, const std::string& name) {
  return std::find(list.begin(), list.end(), name) != list.end();
}

std::vector<std::string> words(const YAML::Node& node, const std::string& what) {
  std::vector<std::string> out;
  if (node.IsScalar()) return {textOf(node, what)};
  if (!node.IsSequence() || node.size() == 0) refuse(node, what + " must be a word or a list of words");
  for (const auto& item : node) {
    out.push_back(textOf(item, what));
    if (std::count(out.begin(), out.end(), out.back()) > 1) refuse(item, "\"" + out.back() + "\" occurs twice");
  }
  return out;
}

// ---- Steps ----

std::vector<Step> steps(const YAML::Node& node);

void wantNothing(const YAML::Node& value, const std::string& name) {
  if (!value.IsNull()) refuse(value, "step \"" + name + "\" takes no value");
}

Step step(const std::string& name, const YAML::Node& value) {
  const std::string what = "step \"" + name + "\"";
  if (name == "attach") return wantNothing(value, name), Attach{};
  if (name == "destroy") return wantNothing(value, name), DestroyStep{};
  if (name == "vanish") return wantNothing(value, name), Vanish{};
  if (name == "half-open") return wantNothing(value, name), HalfOpen{};
  if (name == "reconnect") return wantNothing(value, name), Reconnect{};
  if (name == "jump") return value.IsNull() ? Jump{} : Jump{textOf(value, what)};
  if (name == "look-at-mirror") return value.IsNull() ? LookAtMirror{} : LookAtMirror{textOf(value, what)};
  if (name == "idle") return Idle{numberOf(value, what, 0, Bounds::seconds)};
  if (name == "stop-reading") return StopReading{numberOf(value, what, 0, Bounds::seconds)};
  if (name == "fly") {
    Fly fly;
    if (value.IsNull()) return fly;
    YamlMap map(value, what);
    if (const auto through = map.find("through")) fly.through = words(*through, "\"through\"");
    fly.seconds = map.number("seconds", 0.1, 600, fly.seconds);
    return map.finish(), fly;
  }
  if (name == "build") {
    if (!value.IsMap()) return BuildStep{static_cast<uint32_t>(wholeOf(value, what, 1, Bounds::placements)), {}};
    YamlMap map(value, what);
    BuildStep build{static_cast<uint32_t>(map.whole("count", 1, Bounds::placements, 1)), map.text("prefab", "")};
    return map.finish(), build;
  }
  if (name == "light") {
    Light light;
    if (value.IsNull()) return light;
    YamlMap map(value, what);
    light.elevation = map.number("elevation", -90, 90);
    light.azimuth = map.number("azimuth", -360, 360);
    return map.finish(), light;
  }
  if (name == "repeat") {
    YamlMap map(value, what);
    Repeat repeat{static_cast<uint32_t>(map.whole("times", 1, 1'000'000, 1)), steps(map.need("steps"))};
    return map.finish(), repeat;
  }
  refuse(value, "unknown " + what +
                    "; there are attach, fly, jump, look-at-mirror, build, destroy, light, idle, stop-reading, vanish, "
                    "half-open, reconnect, repeat");
}

std::vector<Step> steps(const YAML::Node& node) {
  if (!node.IsSequence() || node.size() == 0) refuse(node, "\"steps\" must be a list of steps");
  std::vector<Step> out;
  for (const auto& item : node) {
    if (item.IsScalar()) {
      YAML::Node nothing(YAML::NodeType::Null);
      try {
        out.push_back(step(item.Scalar(), nothing));
      } catch (Wrong& wrong) {  // a node of our own has no line
        wrong.line = item.Mark().line + 1;
        throw;
      }
      continue;
    }
    if (!item.IsMap() || item.size() != 1) refuse(item, "a step is a name, or one name with its value");
    out.push_back(step(textOf(item.begin()->first, "a step"), item.begin()->second));
  }
  return out;
}

/// What a client can do depends on whether it is attached: walks the steps as it would.
void checkOrder(const std::vector<Step>& steps, bool& attached, const Group& group, const YAML::Node& node) {
  for (const Step& step : steps) {
    if (const auto* repeat = std::get_if<Repeat>(&step)) {
      for (int i = 0; i < 2; ++i) checkOrder(repeat->steps, attached, group, node);
      continue;
    }
    if (std::holds_alternative<Attach>(step) || std::holds_alternative<Reconnect>(step)) attached = true;
    const bool watches = std::holds_alternative<Fly>(step) || std::holds_alternative<Jump>(step) ||
                         std::holds_alternative<LookAtMirror>(step) || std::holds_alternative<StopReading>(step) ||
                         std::holds_alternative<Vanish>(step) || std::holds_alternative<HalfOpen>(step);
    if (watches && !attached)
      refuse(node,
             "group \"" + group.name + "\": step \"" + nameOf(step) + "\" needs \"attach\" or \"reconnect\" before");
    if (std::holds_alternative<Vanish>(step) || std::holds_alternative<HalfOpen>(step)) attached = false;
    if (group.open() && secondsOf(step) > 1 / group.rate)
      refuse(node, "group \"" + group.name + "\": step \"" + nameOf(step) +
                       "\" lasts longer than the time between two steps at this rate, so the rate could not be kept");
  }
}

// ---- The parts of a scenario ----

Network network(const YAML::Node& node) {
  YamlMap map(node, "network");
  Network out;
  out.delay_ms = map.number("delay_ms", 0, 10'000, 0);
  out.rate_kbps = map.number("rate_kbps", 8, 10'000'000, 0);
  out.loss = map.number("loss", 0, 0.5, 0);
  return map.finish(), out;
}

void think(const YAML::Node& node, Group& group) {
  const std::string what = "\"think\"";
  if (node.IsSequence()) {
    if (node.size() != 2) refuse(node, what + " is seconds, or [least, most]");
    group.think_low = numberOf(node[0], what, 0, 600);
    group.think_high = numberOf(node[1], what, group.think_low, 600);
  } else {
    group.think_low = group.think_high = numberOf(node, what, 0, 600);
  }
}

void size(const std::string& text, const YAML::Node& node, Group& group) {
  char more;
  if (std::sscanf(text.c_str(), "%ux%u%c", &group.width, &group.height, &more) != 2 || group.width < 16 ||
      group.height < 16 || group.width > 8192 || group.height > 8192)
    refuse(node, "\"size\" is \"" + text + "\"; give WIDTHxHEIGHT in pixels, 16 to 8192 each");
}

Group group(const YAML::Node& node, const Scenario& scenario) {
  Group out;
  YamlMap map(node, "a group");
  out.name = map.text("name");
  out.clients = static_cast<uint32_t>(map.whole("clients", 1, Bounds::clients, 1));
  if (const auto worlds = map.find("worlds")) out.worlds = words(*worlds, "\"worlds\"");
  for (const auto& world : out.worlds)
    if (std::none_of(scenario.worlds.begin(), scenario.worlds.end(), [&](const auto& w) { return w.name == world; }))
      refuse(node["worlds"], "the scenario has no world \"" + world + "\"");
  if (out.worlds.empty())
    for (const auto& world : scenario.worlds) out.worlds.push_back(world.name);
  if (const auto variants = map.find("variants")) out.variants = words(*variants, "\"variants\"");
  for (const auto& variant : out.variants)
    if (!contains(scenario.variants, variant))
      refuse(node["variants"], "the scenario has no variant \"" + variant + "\"");
  if (const auto given = map.find("size")) size(textOf(*given, "\"size\""), *given, out);
  out.fps = static_cast<uint32_t>(map.whole("fps", 1, 1000, out.fps));
  out.quality = static_cast<uint32_t>(map.whole("quality", 1, 100, out.quality));
  out.max_latency_ms = static_cast<uint32_t>(map.whole("max_latency_ms", 10, 60'000, out.max_latency_ms));
  out.bounces = static_cast<uint32_t>(map.whole("bounces", 0, 32, out.bounces));
  out.samples = static_cast<uint32_t>(map.whole("samples", 1, 64, out.samples));
  out.primary = map.oneOf("primary", {"raster", "traced"}, out.primary);
  out.check_pictures = map.flag("check_pictures", false);
  out.start = map.number("start", 0, Bounds::seconds, 0);
  out.ramp = map.number("ramp", 0, Bounds::seconds, 0);
  out.loops = static_cast<uint32_t>(map.whole("loops", 0, 1'000'000, 0));
  out.rate = map.number("rate", 0.001, 1000, 0);
  const auto arrivals = map.find("arrivals");
  if (arrivals && !out.open()) refuse(*arrivals, "\"arrivals\" goes with \"rate\"");
  out.poisson = map.oneOf("arrivals", {"even", "poisson"}, "even") == "poisson";
  if (const auto given = map.find("think")) {
    if (out.open()) refuse(*given, "\"think\" is for closed loops; this group has a \"rate\"");
    think(*given, out);
  }
  if (const auto given = map.find("network")) out.network = network(*given);
  out.steps = steps(map.need("steps"));
  map.finish();
  bool attached = false;
  for (int i = 0; i < (out.loops == 1 ? 1 : 2); ++i) checkOrder(out.steps, attached, out, node);
  return out;
}

Objective objective(const YAML::Node& node, const Scenario& scenario) {
  Objective out;
  YamlMap map(node, "an objective");
  out.metric = map.text("of");
  if (!isMetric(out.metric))
    refuse(node["of"], "there is no metric \"" + out.metric + "\"; tests/load/README.md lists them");
  if (hasStatistic(out.metric)) {
    map.need("statistic");
    out.statistic = map.oneOf("statistic", {"min", "mean", "p50", "p95", "p99", "p99.9", "max"}, "");
  }
  out.group = map.text("group", "");
  if (!out.group.empty() && !knowsGroups(out.metric)) refuse(node["group"], out.metric + " is of all clients");
  if (!out.group.empty() &&
      std::none_of(scenario.groups.begin(), scenario.groups.end(), [&](const auto& g) { return g.name == out.group; }))
    refuse(node["group"], "the scenario has no group \"" + out.group + "\"");
  out.variant = map.text("variant", "");
  out.against = map.text("against", "");
  for (const char* key : {"variant", "against"})
    if (const auto given = map.find(key); given && !contains(scenario.variants, given->Scalar()))
      refuse(*given, "the scenario has no variant \"" + given->Scalar() + "\"");
  if (!out.against.empty() && out.variant.empty()) refuse(node, "\"against\" needs a \"variant\" to compare");
  const auto by = map.find("by");
  if (by && out.against.empty()) refuse(*by, "\"by\" goes with \"against\"");
  out.difference = map.oneOf("by", {"percent", "difference"}, "percent") == "difference";
  const auto most = map.find("at_most"), least = map.find("at_least");
  if (most.has_value() == least.has_value()) refuse(node, "an objective has either \"at_most\" or \"at_least\"");
  out.at_most = most.has_value();
  out.limit = numberOf(most ? *most : *least, "the limit", -1e12, 1e12);
  out.name = map.text("name", "");
  map.finish();
  if (out.name.empty()) {
    out.name = (out.statistic.empty() ? "" : out.statistic + " of ") + out.metric;
    if (!out.group.empty()) out.name += " of " + out.group;
    if (!out.variant.empty()) out.name += ", " + out.variant;
    if (!out.against.empty()) out.name += " against " + out.against;
  }
  return out;
}

WorldSpec world(const YAML::Node& node) {
  YamlMap map(node, "a world");
  WorldSpec out;
  out.name = map.text("name");
  const auto instances = map.find("instances");
  out.existing = map.flag("existing", false);
  if (out.existing && instances) refuse(*instances, "a world that exists has the instances that it has");
  if (instances) out.instances = static_cast<uint32_t>(wholeOf(*instances, "\"instances\"", 1000, 1'000'000));
  out.seed = map.whole("seed", 0, UINT64_MAX, 1);
  return map.finish(), out;
}

template <typename T, typename Read>
std::vector<T> listOf(YamlMap& map, const std::string& key, const Read& read) {
  const YAML::Node list = map.need(key);
  if (!list.IsSequence() || list.size() == 0) refuse(list, "\"" + key + "\" must be a list");
  std::vector<T> out;
  std::set<std::string> names;
  for (const auto& item : list) {
    out.push_back(read(item));
    if (!names.insert(out.back().name).second) refuse(item, "\"" + out.back().name + "\" occurs twice in " + key);
  }
  return out;
}

Scenario scenario(const YAML::Node& node) {
  Scenario out;
  YamlMap map(node, "the scenario");
  out.name = map.text("name");
  out.description = map.text("description", "");
  out.seed = map.whole("seed", 0, UINT64_MAX, out.seed);
  out.duration = map.number("duration", 0.5, Bounds::seconds, out.duration);
  out.warm_up = map.number("warm_up", 0, out.duration / 2, std::min(out.warm_up, out.duration / 2));
  out.frames = map.whole("frames", 0, 1'000'000'000, 0);
  out.rounds = static_cast<uint32_t>(map.whole("rounds", 1, Bounds::rounds, 1));
  if (const auto variants = map.find("variants")) out.variants = words(*variants, "\"variants\"");
  if (const auto given = map.find("synthetic")) {
    YamlMap synthetic(*given, "synthetic");
    out.synthetic_frame_us = static_cast<uint32_t>(synthetic.whole("frame_us", 0, 10'000'000, 0));
    out.synthetic_noise = static_cast<uint32_t>(synthetic.whole("noise", 0, 100, 0));
    synthetic.finish();
  }
  out.worlds = listOf<WorldSpec>(map, "worlds", world);
  if (out.worlds.size() > Bounds::worlds)
    refuse(node["worlds"], "there are more than " + std::to_string(Bounds::worlds) + " worlds");
  out.groups = listOf<Group>(map, "groups", [&](const YAML::Node& item) { return group(item, out); });
  if (out.clients() > Bounds::clients)
    refuse(node["groups"], "the groups have more than " + std::to_string(Bounds::clients) + " clients together");
  out.objectives = listOf<Objective>(map, "objectives", [&](const YAML::Node& item) { return objective(item, out); });
  map.finish();
  return out;
}

}  // namespace

std::string nameOf(const Step& step) {
  static const std::array<const char*, std::variant_size_v<Step>> names = {
      "attach", "fly",          "jump",   "look-at-mirror", "build",     "destroy", "light",
      "idle",   "stop-reading", "vanish", "half-open",      "reconnect", "repeat"};
  return names[step.index()];
}

double secondsOf(const Step& step) {
  if (const auto* fly = std::get_if<Fly>(&step)) return fly->seconds;
  if (const auto* idle = std::get_if<Idle>(&step)) return idle->seconds;
  if (const auto* stop = std::get_if<StopReading>(&step)) return stop->seconds;
  return 0;
}

namespace {

bool breaks(const std::vector<Step>& steps) {
  return std::any_of(steps.begin(), steps.end(), [](const Step& step) {
    if (const auto* repeat = std::get_if<Repeat>(&step)) return breaks(repeat->steps);
    return std::holds_alternative<Vanish>(step) || std::holds_alternative<HalfOpen>(step);
  });
}

}  // namespace

bool Group::relayed() const { return network.any() || breaks(steps); }

uint32_t Scenario::clients() const {
  uint32_t sum = 0;
  for (const auto& group : groups) sum += group.clients;
  return sum;
}

Result<Scenario> parseScenario(const std::string& text) {
  const auto wrong = [](int line, const std::string& message) {
    return invalid("scenario", "", "line " + std::to_string(line) + ": " + message);
  };
  try {
    return scenario(YAML::Load(text));
  } catch (const Wrong& error) { return wrong(error.line, error.message); } catch (const YAML::Exception& error) {
    return wrong(error.mark.line + 1, "not YAML: " + error.msg);
  }
}

Result<Scenario> readScenario(const std::string& path) {
  std::ifstream file(path);
  std::ostringstream text;
  text << file.rdbuf();
  if (!file) return invalid("scenario", path, "cannot read the scenario " + path);
  auto parsed = parseScenario(text.str());
  if (!parsed) return invalid("scenario", path, path + ": " + parsed.error().message);
  return parsed;
}

}  // namespace helio::load
