// What a load test does, as its file says it. tests/load/README.md documents the format.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "base/result.h"

namespace helio::load {

/// The most that one scenario may ask for: it is a test, and it ends.
struct Bounds {
  static constexpr uint64_t clients = 256;
  static constexpr uint64_t worlds = 16;
  static constexpr double seconds = 3600;  ///< of one run
  static constexpr uint64_t rounds = 50;
  static constexpr uint64_t placements = 10'000;  ///< of one build
};

/// What lies between a client and the server, both ways alike.
struct Network {
  double delay_ms = 0;   ///< one way
  double rate_kbps = 0;  ///< kilobits a second; 0: as fast as it goes
  double loss = 0;       ///< probability that a segment of 1,460 bytes is lost and sent again
  bool any() const { return delay_ms > 0 || rate_kbps > 0 || loss > 0; }
};

struct WorldSpec {
  std::string name;
  uint32_t instances = 1000;
  uint64_t seed = 1;
  bool existing = false;  ///< used as it is: neither made nor deleted
};

// ---- Steps ----
struct Attach {};
struct Fly {
  std::vector<std::string> through;  ///< named cameras; empty: all of the world's
  double seconds = 4;
};
struct Jump {
  std::string camera;  ///< empty: any but the present one
};
struct LookAtMirror {
  std::string prefab = "glass_hall";
};
struct BuildStep {
  uint32_t count = 1;
  std::string prefab;  ///< empty: the smallest that may be built
};
struct DestroyStep {};  ///< the client's whole plot
struct Light {
  std::optional<double> elevation, azimuth;  ///< degrees; none: any
};
struct Idle {
  double seconds = 1;
};
struct StopReading {
  double seconds = 1;
};
struct Vanish {};    ///< the connection is cut, without a word
struct HalfOpen {};  ///< the connection stays open and carries nothing any more
struct Reconnect {};
struct Repeat;

using Step = std::variant<Attach, Fly, Jump, LookAtMirror, BuildStep, DestroyStep, Light, Idle, StopReading, Vanish,
                          HalfOpen, Reconnect, Repeat>;
struct Repeat {
  uint32_t times = 1;
  std::vector<Step> steps;
};

/// "jump", "look-at-mirror", ...
std::string nameOf(const Step& step);
/// What the step itself lasts, apart from waiting for answers.
double secondsOf(const Step& step);

struct Group {
  std::string name;
  uint32_t clients = 1;
  std::vector<std::string> worlds;    ///< its clients take them in turn
  std::vector<std::string> variants;  ///< takes part in these runs only; empty: in all
  uint32_t width = 160, height = 90, fps = 30, quality = 80, max_latency_ms = 1000, bounces = 3, samples = 1;
  std::string primary = "raster";
  bool check_pictures =
      false;             ///< decodes every picture, and compares it with what the frame says (synthetic renderer)
  double ramp = 0;       ///< seconds over which its clients start
  double start = 0;      ///< seconds after the run's start
  uint32_t loops = 0;    ///< times that the steps are done; 0: to the end
  double rate = 0;       ///< steps a second and client, open loop; 0: closed loop
  bool poisson = false;  ///< with rate: at random moments
  double think_low = 0, think_high = 0;  ///< seconds between steps, closed loop
  Network network;
  std::vector<Step> steps;

  bool open() const { return rate > 0; }
  /// Whether its connections go through a relay: a network, or a step that breaks a connection.
  bool relayed() const;
};

struct Objective {
  std::string name, metric;
  std::string statistic;    ///< "p99", ...; empty: the metric is one number
  std::string group;        ///< empty: all clients
  std::string variant;      ///< empty: all runs
  std::string against;      ///< the variant that it is compared with; empty: none
  bool difference = false;  ///< with against: by difference instead of per cent
  bool at_most = true;
  double limit = 0;
};

struct Scenario {
  std::string name, description;
  uint64_t seed = 1;
  double duration = 10;  ///< seconds of one run
  double warm_up = 1;    ///< seconds whose figures do not count, but for attaching
  uint64_t frames = 0;   ///< the run ends after so many frames of all clients together; 0: no bound
  uint32_t rounds = 1;
  std::vector<std::string> variants;                     ///< a round is one run of each; empty: one run without a name
  uint32_t synthetic_frame_us = 0, synthetic_noise = 0;  ///< of a server that is started with --spawn synthetic
  std::vector<WorldSpec> worlds;
  std::vector<Group> groups;
  std::vector<Objective> objectives;

  uint32_t clients() const;
};

/// Errors (invalid): line and name of what is wrong.
Result<Scenario> parseScenario(const std::string& text);
Result<Scenario> readScenario(const std::string& path);

}  // namespace helio::load
