#include "load/run.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <map>
#include <numbers>
#include <thread>
#include <utility>

#include "load/script.h"

namespace helio::load {
namespace {

using namespace std::chrono_literals;

constexpr auto kProgressPeriod = 250ms;
constexpr uint32_t kTelemetryMs = 500;
constexpr auto kGrace = 10s;     // for clients that wait for an answer when the run ends
constexpr auto kPatience = 60s;  // then the server is stuck, and so would this process be
constexpr size_t kMostInstances = 2'000'000;

bool takesPart(const Group& group, const std::string& variant) {
  return variant.empty() || group.variants.empty() ||
         std::find(group.variants.begin(), group.variants.end(), variant) != group.variants.end();
}

const LookAtMirror* mirrorIn(const std::vector<Step>& steps) {
  for (const Step& step : steps) {
    if (const auto* mirror = std::get_if<LookAtMirror>(&step)) return mirror;
    if (const auto* repeat = std::get_if<Repeat>(&step))
      if (const auto* mirror = mirrorIn(repeat->steps)) return mirror;
  }
  return nullptr;
}

/// From eight sides of every instance of the prefab, as far away as it is large.
std::vector<client::View> viewsOf(const std::string& prefab_name, const std::vector<v1::Prefab>& prefabs,
                                  const std::vector<v1::Instance>& instances) {
  const auto prefab =
      std::find_if(prefabs.begin(), prefabs.end(), [&](const auto& p) { return p.name() == prefab_name; });
  std::vector<client::View> views;
  if (prefab == prefabs.end()) return views;
  const auto& low = prefab->bounds().min();
  const auto& high = prefab->bounds().max();
  const float size = std::max({high.x() - low.x(), high.y() - low.y(), high.z() - low.z(), 1.0f});
  for (const auto& instance : instances) {
    if (instance.prefab() != prefab_name) continue;
    const auto& m = instance.transform();
    const glm::vec3 middle(m[9], m[10] + 0.5f * (low.y() + high.y()), m[11]);
    for (int side = 0; side < 8; ++side) {
      const float angle = float(side) * std::numbers::pi_v<float> / 4;
      const glm::vec3 from = middle + 1.5f * size * glm::vec3(std::cos(angle), 0.2f, std::sin(angle));
      views.push_back(client::lookAt(from, middle, 1.0f));
    }
  }
  return views;
}

/// Makes a run's worlds, knows them, and deletes them in the end.
class Worlds {
 public:
  Worlds(const Scenario& scenario, client::Connection& connection) : scenario_(scenario), connection_(connection) {}
  ~Worlds() {
    for (const auto& name : made_)
      if (auto deleted = connection_.deleteWorld(name); !deleted)
        std::cerr << "helio-load: world " << name << " stays: " << deleted.error().message << "\n";
  }
  Worlds(const Worlds&) = delete;
  Worlds& operator=(const Worlds&) = delete;

  Result<void> make() {
    for (const WorldSpec& spec : scenario_.worlds) {
      if (!spec.existing) {
        v1::CreateWorldRequest request;
        request.set_world(spec.name);
        request.mutable_city()->set_seed(spec.seed);
        request.mutable_city()->set_instances(spec.instances);
        if (auto made = connection_.createWorld(request); !made) return made.error();
        made_.push_back(spec.name);
      }
    }
    for (const WorldSpec& spec : scenario_.worlds)
      if (auto known = learn(spec.name); !known) return known;
    return {};
  }
  const Stage& operator[](const std::string& name) const { return stages_.at(name); }

 private:
  Result<void> learn(const std::string& name) {
    Stage& stage = stages_[name];
    auto world = connection_.readyWorld(name);
    if (!world) return world.error();
    stage.world = std::move(*world);
    auto prefabs = connection_.prefabs(name);
    if (!prefabs) return prefabs.error();
    stage.prefabs = std::move(*prefabs);
    for (const Group& group : scenario_.groups)
      if (const auto* mirror = mirrorIn(group.steps); mirror && stage.mirrors.empty()) {
        auto instances = connection_.instances(name, 0, 0, 1e6f, kMostInstances);
        if (!instances) return instances.error();
        stage.mirrors = viewsOf(mirror->prefab, stage.prefabs, *instances);
      }
    return {};
  }

  const Scenario& scenario_;
  client::Connection& connection_;
  std::map<std::string, Stage> stages_;
  std::vector<std::string> made_;
};

/// Watches the server's telemetry on a connection of its own.
class Telemetry {
 public:
  Telemetry(std::string server, Clock::time_point start) : connection_(std::move(server)), start_(start) {
    thread_ = std::thread([this] { watch(); });
  }
  ~Telemetry() { finish(); }

  std::vector<ServerSample> finish() {
    ended_ = true;
    if (thread_.joinable()) thread_.join();
    return std::move(samples_);
  }

 private:
  void watch() {
    v1::WatchTelemetryRequest request;
    request.set_interval_ms(kTelemetryMs);
    const auto watched = connection_.watch(request, [this](const v1::TelemetrySample& sample) {
      ServerSample out{secondsBetween(start_, Clock::now()), double(sample.resident_bytes()), 0};
      for (const auto& world : sample.worlds()) out.ticks_per_second += double(world.ticks_per_second());
      if (!ended_) samples_.push_back(out);
      return !ended_;
    });
    if (!watched) std::cerr << "helio-load: no telemetry: " << watched.error().message << "\n";
  }

  client::Connection connection_;
  const Clock::time_point start_;
  std::atomic<bool> ended_ = false;
  std::vector<ServerSample> samples_;  ///< the thread's, until it has ended
  std::thread thread_;
};

/// The clients of a run, each on a thread.
class Cast {
 public:
  Cast(Clock::time_point start, double duration) : start_(start), curtain_(start + durationOf(duration)) {}

  Result<void> gather(const Scenario& scenario, const std::string& variant, const Worlds& worlds,
                      const std::string& server) {
    std::map<std::string, uint32_t> plots;
    std::seed_seq sequence{scenario.seed, uint64_t{0}};
    std::vector<uint64_t> seeds(scenario.clients());
    std::mt19937_64 random(sequence);
    for (auto& seed : seeds) seed = random();  // the same for every variant and round

    size_t client = 0;
    for (size_t g = 0; g < scenario.groups.size(); ++g) {
      const Group& group = scenario.groups[g];
      for (uint32_t i = 0; i < group.clients; ++i, ++client) {
        const std::string& world = group.worlds[i % group.worlds.size()];
        const uint32_t plot = plots[world]++;
        if (!takesPart(group, variant)) continue;
        const Stage& stage = worlds[world];
        const double delay = group.start + group.ramp * i / group.clients;
        auto record = std::make_unique<Record>(start_);
        auto script = Script::prepare({&group, &stage, server, Plot(world, stage.world.bounds(), plot), seeds[client],
                                       start_ + durationOf(delay), start_ + durationOf(scenario.warm_up)},
                                      curtain_, *record);
        if (!script) return script.error();
        scripts_.push_back(std::move(*script));
        results_.push_back({g, std::move(record)});
      }
    }
    return {};
  }

  void play() {
    running_ = scripts_.size();
    for (auto& script : scripts_)
      threads_.emplace_back([this, raw = script.get()] {
        raw->run();
        --running_;
      });
  }

  Counts counts() const {
    Counts sum;
    for (const auto& client : results_) {
      const Counts c = client.record->counts();
      sum.frames += c.frames;
      sum.bytes += c.bytes;
      sum.dropped += c.dropped;
      sum.steps += c.steps;
      sum.failed_steps += c.failed_steps;
      sum.ended_streams += c.ended_streams;
      sum.acknowledged_edits += c.acknowledged_edits;
    }
    return sum;
  }

  bool playing() const { return !curtain_.fallen(); }

  /// Lowers the curtain and waits for everybody. A server that answers nobody cannot keep this process alive.
  void end() {
    curtain_.fall();
    const auto fallen = Clock::now();
    while (running_ > 0) {
      std::this_thread::sleep_for(10ms);
      const auto waited = Clock::now() - fallen;
      if (waited > kPatience) {
        std::cerr << "helio-load: " << running_
                  << " clients still wait for an answer a minute after the end: the server "
                  << "is stuck\n";
        std::_Exit(EXIT_FAILURE);
      }
      if (waited > kGrace)
        for (auto& script : scripts_) script->cancel();
    }
    for (auto& thread : threads_) thread.join();
  }

  const std::vector<std::unique_ptr<Script>>& scripts() const { return scripts_; }
  std::vector<ClientResult> results() { return std::move(results_); }

 private:
  const Clock::time_point start_;
  Curtain curtain_;
  std::vector<ClientResult> results_;
  std::vector<std::unique_ptr<Script>> scripts_;
  std::atomic<size_t> running_ = 0;
  std::vector<std::thread> threads_;
};

Result<Plot::Verdict> verify(client::Connection& connection, const Plot& plot) {
  auto instances = connection.instances(plot.world(), plot.middle().x, plot.middle().y, Plot::kRadius, kMostInstances);
  if (!instances) return instances.error();
  return plot.verify(*instances);
}

}  // namespace

Result<RunResult> run(const Scenario& scenario, const std::string& variant, uint32_t round, const std::string& server,
                      const std::function<void(const Progress&)>& progress) {
  client::Connection connection(server);
  auto info = connection.serverInfo();
  if (!info) return info.error();
  Worlds worlds(scenario, connection);
  if (auto made = worlds.make(); !made) return made.error();

  const auto start = Clock::now();
  RunResult result{variant, round, 0, scenario.warm_up, info->version(), info->device(), {}, {}, 0, 0};
  Cast cast(start, scenario.duration);
  if (auto gathered = cast.gather(scenario, variant, worlds, server); !gathered) return gathered.error();
  if (cast.scripts().empty()) return invalid("variants", variant, "no group takes part in variant \"" + variant + "\"");
  Telemetry telemetry(server, start);
  cast.play();
  while (cast.playing()) {
    std::this_thread::sleep_for(kProgressPeriod);
    const Counts counts = cast.counts();
    progress({secondsBetween(start, Clock::now()), scenario.duration, counts});
    if (scenario.frames > 0 && counts.frames >= scenario.frames) break;
  }
  result.seconds = secondsBetween(start, Clock::now());
  cast.end();
  result.server = telemetry.finish();
  for (const auto& script : cast.scripts()) {
    if (!script->plot().used()) continue;
    const auto verdict = verify(connection, script->plot());
    if (!verdict) return verdict.error();
    result.lost_edits += verdict->lost;
    result.doubled_edits += verdict->doubled;
  }
  result.clients = cast.results();
  return result;
}

// ---- Figures of a run

namespace {

template <typename Each>
void forClients(const Scenario& scenario, const RunResult& run, const std::string& group, const Each& each) {
  for (const auto& client : run.clients)
    if (group.empty() || scenario.groups[client.group].name == group) each(*client.record);
}

uint64_t framesAfter(const Record& record, double seconds) {
  const auto& frames = record.frames();
  return static_cast<uint64_t>(
      std::count_if(frames.begin(), frames.end(), [&](const Sample& frame) { return double(frame.t) >= seconds; }));
}

std::optional<double> memoryDrift(const RunResult& run) {
  const auto mean = [&](double from, double to) {
    double sum = 0, count = 0;
    for (const auto& sample : run.server)
      if (sample.t >= from * run.seconds && sample.t < to * run.seconds) sum += sample.memory_bytes, ++count;
    return sum / count;
  };
  const double drift = 100 * (mean(0.75, 1) / mean(0.25, 0.5) - 1);
  if (!std::isfinite(drift)) return std::nullopt;
  return drift;
}

}  // namespace

std::vector<double> valuesOf(const Scenario& scenario, const RunResult& run, const std::string& metric,
                             const std::string& group) {
  std::vector<double> out;
  const auto series = seriesOf(metric);
  if (metric == "server_memory_mib")
    for (const auto& sample : run.server) out.push_back(sample.memory_bytes / (1 << 20));
  forClients(scenario, run, group, [&](const Record& record) {
    if (series) {
      const bool always = *series == kAttach || *series == kFirstFrame || *series == kReattach;
      for (const Sample& sample : record.series(*series))
        if (always || double(sample.t) >= run.warm_up) out.push_back(double(sample.value));
    } else if (metric == "frames_per_second" && record.watched() > 0) {
      out.push_back(double(framesAfter(record, run.warm_up)) / record.watched());
    } else if (metric == "kilobits_per_second" && record.watched() > 0) {
      double bytes = 0;
      for (const Sample& frame : record.frames())
        if (double(frame.t) >= run.warm_up) bytes += double(frame.value);
      out.push_back(bytes * 8 / 1000 / record.watched());
    }
  });
  std::sort(out.begin(), out.end());
  return out;
}

std::optional<double> numberOf(const Scenario& scenario, const RunResult& run, const std::string& metric,
                               const std::string& group) {
  if (metric == "lost_edits") return double(run.lost_edits);
  if (metric == "doubled_edits") return double(run.doubled_edits);
  if (metric == "server_memory_drift_percent") return memoryDrift(run);
  uint64_t Counts::*const counter = metric == "frames"           ? &Counts::frames
                                    : metric == "dropped_frames" ? &Counts::dropped
                                    : metric == "steps"          ? &Counts::steps
                                    : metric == "failed_steps"   ? &Counts::failed_steps
                                    : metric == "ended_streams"  ? &Counts::ended_streams
                                    : metric == "wrong_pictures" ? &Counts::wrong_pictures
                                                                 : &Counts::acknowledged_edits;
  uint64_t sum = 0;
  forClients(scenario, run, group, [&](const Record& record) { sum += record.counts().*counter; });
  return double(sum);
}

}  // namespace helio::load
