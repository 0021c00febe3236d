#include "daemon/configuration.h"

#include <yaml-cpp/yaml.h>

#include <CLI/CLI.hpp>
#include <cctype>
#include <cstdlib>
#include <map>
#include <set>
#include <thread>

#include "render/choices.h"

namespace helio::daemon {
namespace {

constexpr const char* kExamples = R"(Examples:
  heliographd --city 10000                       a city of 10,000 instances, world "city", on 127.0.0.1:7700
  heliographd --device cpu --listen 127.0.0.1:0 --port-file port.txt
                                                 on the software device, at a free port that port.txt names
  heliographd --log-dir ~/worlds                 every acknowledged edit is on disk, and there again after a restart
  heliographd --renderer synthetic               no device: black and white blocks, for measuring the service
  heliographd --gltf-root ~/models               clients may make worlds of the files in there
  heliographd init --keys ~/keys --host example.org
  heliographd --keys ~/keys --listen 0.0.0.0:7700 --ops-listen 127.0.0.1:9700
                                                 for everybody who has a token; health and metrics beside it
  heliographd --config heliographd.yaml --check-config
Every flag --some-name can be set as HELIOGRAPH_SOME_NAME in the environment, and as some-name in the file of --config;
a flag counts before the environment, the environment before the file.
The first SIGTERM or SIGINT tells the viewers and ends in order, the second ends at once.)";

std::string variableOf(std::string flag) {
  for (char& c : flag) c = c == '-' ? '_' : static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return "HELIOGRAPH_" + flag;
}

/// A map of flags without their dashes; values are scalars or lists of them. Unknown keys are refused.
class YamlFile final : public CLI::Config {
 public:
  explicit YamlFile(const CLI::App& app) : app_(app) {}

  /// Whatever has a value.
  std::string to_config(const CLI::App* app, bool, bool, std::string) const override {
    YAML::Emitter out;
    out << YAML::BeginMap;
    for (const auto* option : app->get_options()) {
      if (!option->get_configurable() || option->get_lnames().empty()) continue;
      const std::string name = option->get_lnames().front();
      if (option->count() > 0) out << YAML::Key << name << YAML::Value << option->results().back();
      else if (!option->get_default_str().empty()) out << YAML::Key << name << YAML::Value << option->get_default_str();
    }
    out << YAML::EndMap;
    return std::string(out.c_str()) + "\n";
  }

  std::vector<CLI::ConfigItem> from_config(std::istream& stream) const override {
    try {
      return itemsOf(YAML::Load(stream));
    } catch (const YAML::Exception& error) {
      throw CLI::ConfigError(std::string("the configuration file is no YAML: ") + error.what());
    }
  }

 private:
  std::vector<CLI::ConfigItem> itemsOf(const YAML::Node& file) const {
    std::vector<CLI::ConfigItem> items;
    if (file.IsNull()) return items;
    if (!file.IsMap()) throw CLI::ConfigError("the configuration file is no map of flags to values");
    std::set<std::string> seen;
    for (const auto& entry : file) {
      const auto name = entry.first.as<std::string>();
      const auto* option = app_.get_option_no_throw("--" + name);
      if (!option || !option->get_configurable())
        throw CLI::ConfigError("the configuration file has \"" + name + "\" (line " +
                               std::to_string(entry.first.Mark().line + 1) +
                               "), which is no flag; heliographd --help lists them");
      if (!seen.insert(name).second) throw CLI::ConfigError("the configuration file has \"" + name + "\" twice");
      if (const char* set = std::getenv(option->get_envname().c_str()); set && *set) continue;
      items.push_back({{}, name, valuesOf(name, entry.second)});
    }
    return items;
  }

  static std::vector<std::string> valuesOf(const std::string& name, const YAML::Node& value) {
    if (value.IsScalar()) return {value.as<std::string>()};
    if (!value.IsSequence()) throw CLI::ConfigError("\"" + name + "\" in the configuration file has no plain value");
    return value.as<std::vector<std::string>>();
  }

  const CLI::App& app_;
};

/// Adds flags with their environment variables.
class Flags {
 public:
  explicit Flags(CLI::App& app, std::string group = {}) : app_(app), group_(std::move(group)) {}

  template <typename Value>
  CLI::Option* value(const std::string& name, Value& target, const std::string& help) {
    return finish(app_.add_option("--" + name, target, help)->capture_default_str(), name);
  }
  CLI::Option* toggle(const std::string& name, bool& target, const std::string& help) {
    return finish(app_.add_flag("--" + name, target, help), name);
  }
  /// A number with its range.
  template <typename Value>
  void number(const std::string& name, Value& target, Value low, Value high, const std::string& help) {
    value(name, target, help)->check(CLI::Range(low, high));
  }

 private:
  CLI::Option* finish(CLI::Option* option, const std::string& name) {
    option->envname(variableOf(name));
    if (!group_.empty()) option->group(group_);
    return option;
  }

  CLI::App& app_;
  std::string group_;
};

void addServing(CLI::App& app, Configuration& c, uint64_t& synthetic_frame_us) {
  Flags flags(app);
  flags.value("listen", c.server.address, "host:port; without --keys on loopback only; port 0 picks a free one");
  flags.value("keys", c.server.keys,
              "folder of heliographd init: TLS, and a token for every call; empty: neither, on loopback");
  flags.value("ops-listen", c.ops_address,
              "host:port of /livez, /readyz and /metrics (plain HTTP, nothing of worlds or users); empty: none");
  flags.value("advertise", c.server.advertise,
              "host:port under which clients reach this server, for Resolve; empty: the one they use");
  flags.value("port-file", c.port_file, "file that gets the bound host:port, when the server is ready");
  flags.value("log-dir", c.log_folder,
              "folder that keeps the worlds and their edits over a restart; empty: memory keeps them");
  flags.value("gltf-root", c.server.gltf_root, "folder whose glTF files may become worlds")
      ->check(CLI::ExistingDirectory);
  flags
      .value("price-list", c.server.price_list,
             "accuracy.json of helio-bench accuracy --axis preset: what viewers' goals are followed by")
      ->type_name("FILE");
  flags
      .value("renderer", c.renderer,
             "vulkan, or synthetic: pictures of blocks that say what they show, without a device")
      ->check(CLI::IsMember({"vulkan", "synthetic"}));
  flags.value("synthetic-frame-us", synthetic_frame_us, "microseconds that a tick of the synthetic renderer takes");
  flags.number("synthetic-noise", c.synthetic.noise, 0u, 100u, "grey levels of noise in its pictures");
  flags.value("device", c.device.device, "part of a Vulkan device's name, cpu or gpu; empty: the best there is");
  flags.toggle("validation", c.device.validation, "Vulkan's validation layer");
  flags.toggle("strict-numerics", c.device.strict_numerics,
               "end at the first sample that is not finite, or negative, with a line that says where it was");
  flags.value("city", c.city.instances, "make a city of so many instances at the start, 1,000 to 1,000,000");
  flags.value("seed", c.city.seed, "of that city");
  flags.value("animated", c.city.animated, "moving units of that city, 0 to 10,000");
  flags.value("world-name", c.city_name, "of that city");
  flags.value("log-level", c.log_level, "trace, debug, info, warn, error")
      ->check(CLI::IsMember({"trace", "debug", "info", "warn", "error"}));
  flags.value("log-format", c.log_format, "text, or json: one object a line")->check(CLI::IsMember({"text", "json"}));
}

constexpr render::Choice<render::Culling> kStrategies[] = {
    {"full", render::Culling::full},
    {"frustum_radius", render::Culling::frustum_radius},
    {"lipac", render::Culling::lipac},
};

void addCulling(CLI::App& app, std::string& culling, render::RendererOptions& device) {
  Flags flags(app, "Culling");
  flags
      .value("culling", culling,
             "which instances rays can meet: full (all), frustum_radius (in a frustum or within 800 m), lipac (those "
             "that light paths meet; what it leaves out casts the sun's shadow by a map)")
      ->check(CLI::IsMember(render::namesOf(kStrategies)));
  device.culling_settings.cast_by_map = true;
  accel::LipacSettings& lipac = device.culling_settings.lipac;
  const float most = accel::LipacSettings::kHighestThreshold;
  flags.number("culling-box-activate", lipac.box_activate, 2.0f, most,
               "hits a tick of 1920 x 1080 paths above which a hitbox's instances enter");
  flags.number("culling-box-deactivate", lipac.box_deactivate, 2.0f, most, "and below which they leave again");
  flags.number("culling-own-activate", lipac.own_activate, 2.0f, most,
               "hits above which an instance gets a BLAS of its own");
  flags.number("culling-own-deactivate", lipac.own_deactivate, 2.0f, most, "and below which it loses it");
  flags.value("culling-mitigation", lipac.mitigation,
              "true: what comes into a viewer's sight enters at once; false: when light paths ask for it");
}

void addLimits(CLI::App& app, service::Limits& limits) {
  Flags flags(app, "Limits");
  flags.number("max-worlds", limits.max_worlds, 1u, 1000u,
               "each has a scene in memory and on the device, and a thread");
  flags.number("max-viewers", limits.max_viewers, 1u, 10'000u,
               "with running shots, over all worlds: each has render targets on the device");
  flags.number("max-instances", limits.world.max_instances, uint64_t{1}, uint64_t{16'000'000},
               "of one world: the acceleration structure holds them, in 24 bits");
  flags.number("max-edits-per-call", limits.world.max_edits_per_batch, uint32_t{1}, uint32_t{100'000},
               "one call is one record of the log and holds the world while it is resolved");
  flags.number("max-placements-per-call", limits.world.max_poses_per_batch, uint32_t{1}, uint32_t{1'000'000},
               "likewise, over all builds of a call");
  flags.number("max-edits-per-second", limits.max_edits_per_second, 1u, 100'000'000u,
               "edits and placements of one world: who builds faster makes everybody's ticks long");
  flags.number("max-request-bytes", limits.max_request_bytes, 1u << 16, 1u << 30,
               "a request is held in memory while it is checked");
  flags.number("max-frame-size", limits.max_size, 16u, 16'384u,
               "pixels, of width and of height: one 8192 x 8192 view takes some 5 GB of the device");
  flags.number("max-fps", limits.max_fps, 1u, 240u, "of one viewer: every frame costs everybody's device");
  flags.number("max-shot-samples", limits.max_shot_samples, 1u, 16'777'216u,
               "a pixel: a shot occupies its world for so long");
  flags.number("max-streams-per-connection", limits.max_streams_per_connection, 1u, 10'000u,
               "calls at a time: more wait at the client, so that one connection cannot take all threads");
  flags.number("resume-seconds", limits.resume_seconds, 0u, 3600u,
               "that a broken viewer's render targets wait for its return: they take memory of the device");
  flags.number("max-silence-seconds", limits.max_silence_seconds, 1u, 3600u,
               "that a viewer may owe an acknowledgement before it is taken for dead");
  flags.number("max-scene-bytes", limits.max_scene_bytes, uint64_t{1}, uint64_t{1} << 40,
               "of a glTF file and what lies beside it in --gltf-root: it is read into memory");
}

void addCommands(CLI::App& app, Invocation& invocation) {
  app.require_subcommand(0, 1);
  auto* init = app.add_subcommand("init", "Make a server's keys: an authority, a certificate, an admin token.");
  init->fallthrough();
  init->footer(R"(Prints one line for the clients to paste: helio login HOST:PORT --ca-sha256 ... --token ...
Examples:
  heliographd init --keys ~/keys --host example.org --host 192.0.2.7
  heliographd init --keys ~/keys --host example.org --renew      another certificate, which a running server picks up
  heliographd init --keys ~/keys --new-token                     another admin token, when the first was lost)");
  init->add_option("--host", invocation.init.hosts,
                   "name or address under which clients reach the server; may be repeated; localhost is always in")
      ->envname("HELIOGRAPH_HOST")
      ->delimiter(',');
  init->add_flag("--renew", invocation.init.renew, "another certificate, of the same authority")
      ->envname("HELIOGRAPH_RENEW");
  init->add_flag("--new-token", invocation.init.new_token, "another admin token")->envname("HELIOGRAPH_NEW_TOKEN");
  init->callback([&invocation] { invocation.command = Command::init; });

  auto* doctor =
      app.add_subcommand("doctor", "Check whether this machine can serve, and say how to mend what is wrong.");
  doctor->fallthrough();
  doctor->footer(
      "Give it the flags, environment or file that the server gets. Exit status 0: it can serve.\n"
      "Examples:\n  heliographd doctor --keys ~/keys --listen 0.0.0.0:7700 --log-dir ~/worlds");
  doctor->add_flag("--json", invocation.json, "print one JSON document")->envname("HELIOGRAPH_JSON");
  doctor->callback([&invocation] { invocation.command = Command::doctor; });
}

}  // namespace

Result<std::optional<Invocation>> parseCommandLine(int argc, const char* const* argv) {
  Invocation invocation;
  auto& c = invocation.configuration;
  c.server.version = HELIOGRAPH_VERSION;
  c.server.encoder_threads = std::max(1u, std::thread::hardware_concurrency() / 2);
  uint64_t synthetic_frame_us = 0;
  std::string culling = "full";
  bool check = false;

  CLI::App app("Hosts worlds, renders them, and streams pictures to viewers.", "heliographd");
  app.footer(kExamples);
  app.set_version_flag("--version", c.server.version)->configurable(false);
  addServing(app, c, synthetic_frame_us);
  addCulling(app, culling, c.device);
  addLimits(app, c.server.limits);
  addCommands(app, invocation);
  // CLI11 reads the file before the environment, so the file's name has to be known before.
  const char* file = std::getenv("HELIOGRAPH_CONFIG");
  app.set_config("--config", file ? file : "", "YAML file of flags, without their dashes (HELIOGRAPH_CONFIG)",
                 file && *file);
  app.add_flag("--check-config", check, "print the configuration in effect, and end")
      ->envname("HELIOGRAPH_CHECK_CONFIG")
      ->configurable(false);
  app.config_formatter(std::make_shared<YamlFile>(app));
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() != 0)
      return Error{ErrorKind::invalid, std::string(error.what()) + "; see heliographd --help", {}, {}, {}};
    app.exit(error);
    return std::optional<Invocation>();
  }
  c.device.culling = *render::byName(kStrategies, culling);
  c.synthetic.frame_time = std::chrono::microseconds(synthetic_frame_us);
  if (check) {
    invocation.command = Command::check_configuration;
    c.in_effect = app.config_to_str(true, false);
  }
  return std::optional<Invocation>(std::move(invocation));
}

}  // namespace helio::daemon
